"use strict";
const graph = JSON.parse(document.getElementById("graph").textContent);
const BEYOND = -1, HERE = -2;
const at = (id) => document.getElementById(id);
const doings = graph.doings.map(([kind, group, words, line, refs, kinds, brings]) => (
  { kind, group, words, line, refs, kinds, brings }));
const effects = graph.effects.map(([code, answer, result, keeps, adds, refs, rules, assumes, label, opens, closes, sends]) => (
  { code, answer, result, keeps, adds, refs, rules, assumes: graph.assumes[assumes], label, opens, closes, sends }));
const ambiguities = new Map(graph.ambiguities.map((one) => [one.id, one]));

// The moves out of a state, in the order that positions in links count by.
function moves(state) {
  const flat = graph.states[state][2];
  return Array.from({ length: flat.length / 3 }, (_, i) => (
    { index: i, doing: doings[flat[3 * i]], number: flat[3 * i], effect: effects[flat[3 * i + 1]], to: flat[3 * i + 2] }));
}
const rests = (state) => !moves(state).some((move) => move.doing.kind === "itself");

// Names are serial numbers; texts have nine digits where the name in a position goes.
const filled = (text, names) => text.replace(/(?<!\d)900000(\d{3})(?!\d)/g, (_, position) => String(names[Number(position)]));
function part(number) {
  const kept = graph.parts[number];
  if (Array.isArray(kept)) return kept.map(part);
  if (kept && typeof kept === "object") return Object.fromEntries(kept.k.map((key, i) => [key, part(kept.v[i])]));
  return kept;
}

// A frame is where one stands: the state, its names, what was assumed on the way, and the lines of the history so far.
const START = { state: 0, names: Array.from({ length: graph.names }, (_, i) => i + 1), minted: graph.names, assumed: {}, channels: [], lines: [graph.head], calls: 0 };
const left = (frame, id) => frame.assumed[id] || ambiguities.get(id).possible;
const agrees = (letters, others) => [...letters].filter((letter) => others.includes(letter)).join("");
const fits = (frame, effect) => effect.assumes.every(([id, letters]) => agrees(left(frame, id), letters));
function after(frame, move) {
  const { doing, effect } = move;
  let minted = frame.minted;
  const brought = Array.from({ length: doing.brings }, () => ++minted);
  const known = [...frame.names, ...brought];
  const given = doing.refs.map((ref) => (ref === null ? 0 : known[ref]));
  const pool = [...frame.names, ...Array.from({ length: effect.adds }, () => ++minted)];
  const named = (ref) => (ref < 0 ? given[-ref - 1] : pool[ref]);
  const mentioned = effect.refs.map(named);
  const assumed = { ...frame.assumed };
  for (const [id, letters] of effect.assumes) assumed[id] = agrees(left(frame, id), letters);
  const state = move.to === HERE ? frame.state : move.to;
  const lines = [...frame.lines];
  let calls = frame.calls;
  if (doing.line) {
    const line = JSON.parse(filled(doing.line, known));
    if (doing.kind === "call") {
      line.call = ++calls;
      const answered = { return: calls, ...JSON.parse(filled(effect.result, mentioned)) };
      lines.push(line, answered);
      if (answered.result && "stream" in answered.result && effect.code === "OK") {
        // Who subscribes to look gives the stream up again: nothing is owed to anybody after it.
        lines.push({ call: ++calls, method: "cancel", params: { stream: answered.result.stream } }, { return: calls, result: {} });
      }
    } else lines.push(line);
  }
  let channels = frame.channels.filter((channel) => !effect.closes.includes(channel.topic));
  for (const [topic, , line, refs] of effect.sends) {
    for (const channel of channels) {
      if (line && channel.topic === topic) lines.push({ connection: channel.name, line: JSON.parse(filled(line, refs.map(named))) });
    }
  }
  channels = [...channels, ...effect.opens.map(([topic, ref]) => ({ topic, name: named(ref) }))];
  if (graph.settles && rests(state) && !lines.at(-1).settled) lines.push({ settled: true });
  return { state, names: effect.keeps ? effect.keeps.map(named) : frame.names, minted, assumed, channels, lines, calls, mentioned, move };
}

// Where the page stands: a path, how much of it has been gone, and the readings that are switched off.
let path = [], gone = 0, off = new Set(), trail = [START];
function walked(indices) {
  const found = [START];
  for (const index of indices) {
    const here = found.at(-1);
    const move = moves(here.state)[index];
    if (!move || move.to === BEYOND || !fits(here, move.effect)) return null;
    found.push(after(here, move));
  }
  return found;
}
function position() {
  const said = new URLSearchParams({ g: graph.digest, p: path.join("."), at: String(gone) });
  if (off.size) said.set("off", [...off].sort().join("~"));
  return "#" + said;
}
function restore() {
  const said = new URLSearchParams(location.hash.slice(1));
  let complaint = "";
  let wanted = (said.get("p") || "").split(".").filter(Boolean).map(Number);
  if (said.has("g") && said.get("g") !== graph.digest) {
    complaint = "The link was made by a page with other states than this one, so it leads to the start.";
    wanted = [];
  }
  let found = walked(wanted);
  if (!found) {
    complaint = "The link names steps that this page does not have, so it leads to the start.";
    [wanted, found] = [[], [START]];
  }
  const upTo = Number(said.get("at") ?? wanted.length);
  [path, trail] = [wanted, found];
  gone = Number.isInteger(upTo) && upTo >= 0 && upTo <= path.length ? upTo : path.length;
  off = new Set((said.get("off") || "").split("~").filter((one) => {
    const [id, letter] = one.split("=");
    return ambiguities.has(id) && ambiguities.get(id).possible.includes(letter);
  }));
  at("told").hidden = !complaint;
  at("told").className = "small told";
  at("told").textContent = complaint;
  show();
}
function go() {
  if (location.hash === position()) restore();
  else location.hash = position();
}
function take(index) {
  if (path[gone] !== index) {
    path = [...path.slice(0, gone), index];
    trail = walked(path);
  }
  gone += 1;
  go();
}

// Elements.
function made(tag, attributes = {}, ...content) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name === "onclick") element.addEventListener("click", value);
    else if (value !== false && value !== null) element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...content.filter((one) => one !== null));
  return element;
}
const plain = (text) => text.replace(/^[A-Z_]*?STATE_/, "").toLowerCase();
const short = (text) => (text.length > 90 ? text.slice(0, 89) + "…" : text);

function tree(value) {
  const entries = Array.isArray(value) ? value.map((one, i) => [String(i), one]) : Object.entries(value);
  return made("div", { class: "tree" }, ...entries.map(([key, one]) => {
    const inner = one && typeof one === "object" && Object.keys(one).length;
    return made("div", {}, made("span", { class: "key" }, key + " "), inner ? tree(one) : String(typeof one === "object" ? JSON.stringify(one) : one));
  }));
}
function mission(one) {
  const state = one.state === "STATE_DEFAULT" ? "waiting" : plain(one.state);
  const kind = Object.values(one.missionType || {})[0] || "";
  const active = state === "running" || state === "paused";
  const goals = (one.goals || []).map((goal, i) => made("span", { class: active && i === one.currentGoalIndex ? "current" : "" }, goal.destinationId || (goal.pose ? "a pose" : "somewhere")));
  return made("li", { class: "mission " + state }, made("b", {}, one.missionId), ` ${state} `,
    made("span", { class: "soft small" }, kind.replace(/^.*TYPE_/, "").toLowerCase().replaceAll("_", " ")), made("div", { class: "goals" }, ...goals));
}
function queue(missions) {
  const ended = ["STATE_SUCCEEDED", "STATE_CANCELED", "STATE_FAILED"];
  const lanes = [["active", (one) => ["STATE_RUNNING", "STATE_PAUSED"].includes(one.state)], ["waiting", (one) => one.state === "STATE_DEFAULT"], ["ended", (one) => ended.includes(one.state)]];
  return lanes.map(([name, belongs]) => {
    const some = missions.filter(belongs);
    return made("div", { class: "lane" }, made("span", {}, name), made("ul", {}, ...(some.length ? some.map(mission) : [made("li", { class: "nothing" }, "nothing")])));
  });
}

// What the page shows.
function show() {
  const frame = trail[gone];
  const [words, seen] = graph.states[frame.state];
  const views = graph.views.map((title, i) => [title, seen[i] === null ? null : JSON.parse(filled(JSON.stringify(part(seen[i])), frame.names))]);
  const listed = views.map(([, message]) => message && message.missionStates).find(Boolean);
  at("queue").replaceChildren(...(listed ? queue(listed.missions || []) : []));
  // What the queue shows is not said again.
  at("words").textContent = listed ? words.replace(/^\[.*?\](, )?/, "") : words;
  const unfolded = new Set([...at("views").querySelectorAll("details[open]")].map((one) => one.dataset.view));
  at("views").replaceChildren(...views.map(([title, message]) => made("details", { class: "small", "data-view": title, open: unfolded.has(title) || (!listed && views.length === 1) },
    made("summary", {}, `What ${title} shows`), message === null ? made("p", { class: "soft" }, "nothing") : tree(message))));
  showMap(frame);
  showPath();
  showReadings(frame);
  showDoings(frame);
  at("back").disabled = gone === 0;
  at("forward").disabled = gone === path.length;
  at("start").disabled = gone === 0 && path.length === 0;
  at("history").textContent = transcript(frame);
  const said = frame.lines.length > 1;
  at("copy-history").disabled = at("copy-test").disabled = !said;
}
const transcript = (frame) => frame.lines.map((line) => JSON.stringify(line) + "\n").join("");
function test(frame) {
  const lines = frame.lines.map((line) => "    " + JSON.stringify(JSON.stringify(line)) + ",").join("\n");
  return graph.test.replace(/^.*$/gm, (line) => (line.includes(graph.standIn) ? lines : line));
}
// Names are shown as they are written: a mission's as its text, another's as its kind and its number.
const named = (kind, serial) => (kind ? `${kind} ${serial}` : `mission-${serial}`);
function about(frame, doing) {
  const names = doing.refs.map((ref, i) => (ref === null ? `an unknown ${doing.kinds[i] || "mission"}` : ref < frame.names.length ? named(doing.kinds[i], frame.names[ref]) : null)).filter(Boolean);
  return names.length ? ` of ${names.join(", ")}` : "";
}
function answered(frame, move) {
  const { effect } = move;
  if (!effect.code) return effect.label || (move.doing.kind === "itself" ? "happens" : "comes about");
  return effect.code;
}
function result(text) {
  const found = JSON.parse(text).result;
  return found ? short(Object.entries(found).map(([key, value]) => `${key} ${typeof value === "object" ? JSON.stringify(value) : value}`).join(", ")) : "";
}
function showPath() {
  const steps = trail.slice(1).map((frame, i) => {
    const before = trail[i];
    const outcome = frame.move.effect.code ? ` → ${frame.move.effect.code}` : "";
    return made("li", { class: i + 1 === gone ? "here" : i + 1 > gone ? "ahead" : "" },
      made("button", { type: "button", onclick: () => { gone = i + 1; go(); } }, frame.move.doing.words + about(before, frame.move.doing) + outcome));
  });
  at("path").replaceChildren(...(steps.length ? steps : [made("li", { class: "nothing", style: "list-style:none;margin-left:-1.4rem" }, "Nothing has been done yet.")]));
}
function showReadings(frame) {
  const inPlay = new Set(moves(frame.state).flatMap((move) => move.effect.assumes.map(([id]) => id)));
  const one = (ambiguity) => made("div", { class: "reading", "data-ambiguity": ambiguity.id }, made("strong", {}, ambiguity.id), " " + ambiguity.question,
    made("div", { class: "letters" }, ...[...ambiguity.possible].map((letter) => {
      const assumed = !left(frame, ambiguity.id).includes(letter);
      const key = `${ambiguity.id}=${letter}`;
      const notes = [letter === ambiguity.reference ? "the reference's" : "", ambiguity.flagged.includes(letter) ? "departs from the text" : "", assumed ? "ruled out by a step on the way" : ""].filter(Boolean).join("; ");
      return made("button", { type: "button", "data-reading": key, "aria-pressed": String(!assumed && !off.has(key)), disabled: assumed,
        onclick: () => { if (!off.delete(key)) off.add(key); go(); } },
        made("b", {}, letter), made("span", {}, ambiguity.readings[letter], notes ? made("span", { class: "soft" }, ` (${notes})`) : null));
    })));
  const here = graph.ambiguities.filter((ambiguity) => inPlay.has(ambiguity.id));
  const others = graph.ambiguities.filter((ambiguity) => !inPlay.has(ambiguity.id));
  const open = at("readings").querySelector("details")?.open;
  at("readings").replaceChildren(...(here.length ? here.map(one) : [made("p", { class: "soft small" }, "None matters here.")]),
    ...(others.length ? [made("details", { class: "small", open: Boolean(open) }, made("summary", {}, `${others.length} that matter elsewhere`), ...others.map(one))] : []));
}
const allowed = (frame, effect) => effect.assumes.every(([id, letters]) => [...agrees(left(frame, id), letters)].some((letter) => !off.has(`${id}=${letter}`)));
function showDoings(frame) {
  const here = moves(frame.state).filter((move) => only === null || (move.to >= 0 && shape(move.to) === only));
  const many = new Set(here.map((move) => move.number)).size > 40;
  const folded = new Map([...at("doings").querySelectorAll("details")].map((one) => [one.dataset.group, one.open]));
  const narrowed = only === null ? [] : [made("p", { class: "card only" }, `Only what leads to ${only} `, made("button", { type: "button", onclick: () => { only = null; show(); } }, "Show all"))];
  at("doings").replaceChildren(...narrowed, ...graph.groups.flatMap((group) => {
    const some = here.filter((move) => move.doing.group === group.name);
    if (!some.length) return [];
    const visible = some.filter((move) => allowed(frame, move.effect));
    const byDoing = new Map();
    for (const move of visible) byDoing.set(move.number, [...(byDoing.get(move.number) || []), move]);
    const codes = [...new Set(visible.map((move) => move.effect.code).filter(Boolean))].join(", ");
    const hidden = some.length - visible.length;
    return [made("details", { class: "card", "data-group": group.name, open: folded.has(group.name) ? folded.get(group.name) : !many },
      made("summary", {}, made("strong", {}, group.name), made("span", { class: "soft small" }, codes),
        group.failures.length ? made("span", { class: "soft small" }, `may fail with ${group.failures.join(" or ")} at any time`) : null),
      ...[...byDoing.values()].map((answers) => made("div", { class: "doing" }, made("div", { class: "asked" }, answers[0].doing.words + about(frame, answers[0].doing)),
        ...answers.map((move) => answer(frame, move)))),
      hidden ? made("div", { class: "hidden-note soft small" }, `${hidden} more under readings that are switched off or ruled out`) : null)];
  }));
}
// What a reading is called means little without its words.
function explain(id) {
  const reading = document.querySelector(`[data-ambiguity="${id}"]`);
  for (let part = reading; part; part = part.parentElement) if (part.tagName === "DETAILS") part.open = true;
  reading.scrollIntoView({ block: "center" });
  reading.classList.add("shown");
  setTimeout(() => reading.classList.remove("shown"), 2000);
}
function answer(frame, move) {
  const { effect } = move;
  const beyond = move.to === BEYOND;
  const next = beyond ? null : after(frame, move);
  const detail = effect.code === "OK" && next ? result(filled(effect.result, next.mentioned)) : "";
  const kind = effect.code === "OK" ? "ok" : effect.code ? "refused" : "";
  return made("div", { class: "answer" },
    made("button", { type: "button", class: kind, disabled: beyond, "data-move": String(move.index), title: beyond ? "It leads beyond the bounds of this page." : move.to === HERE ? "Nothing changes." : "", onclick: () => take(move.index) },
      answered(frame, move) + (move.to >= 0 ? " →" : ""), detail ? made("small", {}, detail) : null, beyond ? made("small", {}, "beyond the bounds") : null),
    made("div", { class: "why" }, ...effect.assumes.map(([id, letters]) => made("button", { type: "button", class: "assumes", onclick: () => explain(id), title: ambiguities.get(id).question + "\n" + [...letters].map((letter) => `${letter}: ${ambiguities.get(id).readings[letter]}`).join("\n") }, `${id} = ${[...letters].join(" or ")}`)),
      made("ul", {}, ...effect.rules.map((rule) => made("li", {}, graph.rules[rule].says + " ", made("span", { class: "cite" }, `[${graph.rules[rule].cite}]`))),
        ...effect.sends.map(([, sent]) => made("li", {}, "sends " + sent)))));
}

at("back").addEventListener("click", () => { gone -= 1; go(); });
at("forward").addEventListener("click", () => { gone += 1; go(); });
at("start").addEventListener("click", () => { [path, gone, trail] = [[], 0, [START]]; go(); });
at("all-readings").addEventListener("click", () => { off = new Set(); go(); });
at("reference-readings").addEventListener("click", () => {
  off = new Set(graph.ambiguities.flatMap((one) => [...one.possible].filter((letter) => letter !== one.reference).map((letter) => `${one.id}=${letter}`)));
  go();
});
at("copy-link").addEventListener("click", (event) => copied(event.target, location.href.split("#")[0] + position()));
at("copy-history").addEventListener("click", (event) => copied(event.target, transcript(trail[gone])));
at("copy-test").addEventListener("click", (event) => copied(event.target, test(trail[gone])));
addEventListener("hashchange", restore);
