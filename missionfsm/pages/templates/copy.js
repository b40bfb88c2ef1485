// Pages opened from a file may be refused the clipboard; then what was to be copied is selected in a box of its own.
function copied(button, text) {
  const told = button.textContent;
  const done = (says) => {
    button.textContent = says;
    setTimeout(() => { button.textContent = told; }, 1500);
  };
  const byHand = () => {
    const box = document.createElement("textarea");
    box.value = text;
    document.body.append(box);
    box.select();
    const worked = document.execCommand("copy");
    box.remove();
    done(worked ? "copied" : "copying was refused");
  };
  if (navigator.clipboard) navigator.clipboard.writeText(text).then(() => done("copied"), byHand);
  else byHand();
}
