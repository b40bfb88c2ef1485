// A subject can be told to deviate from its documents in one named way, to see whether the oracle notices.

/**
 * Reads `--break NAME` and `--list-breaks` from the command line. `catalogue` maps each name to one line that says
 * what goes wrong and which place in the page it violates. Returns `broken(name)`; a name outside the catalogue is
 * an error on both sides, on the command line and in the code.
 */
export function breaksFrom(catalogue, args = process.argv.slice(2)) {
  if (args.includes('--list-breaks')) {
    console.log(JSON.stringify(catalogue, null, 2));
    process.exit(0);
  }
  const chosen = chosenBreak(args);
  if (chosen !== null) mustBeListed(catalogue, chosen);
  return (name) => {
    mustBeListed(catalogue, name);
    return name === chosen;
  };
}

function chosenBreak(args) {
  if (args.length === 0) return null;
  if (args.length === 2 && args[0] === '--break') return args[1];
  return usage(`cannot read the arguments ${args.join(' ')}`);
}

function mustBeListed(catalogue, name) {
  if (!Object.hasOwn(catalogue, name)) usage(`there is no break ${name}`);
}

function usage(problem) {
  console.error(`${problem}; usage: [--break NAME | --list-breaks]`);
  process.exit(2);
}
