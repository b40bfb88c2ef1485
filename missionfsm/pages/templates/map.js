// The map: states that are called the same are one node, a shape. What leads there stands in the node, not on a line.
const MOST_NEXT = 10, MOST_BEFORE = 2, WIDTH = 232, NEXT_WIDTH = 380, APART = 60, BETWEEN = 9, NARROW = 720, READABLE = 0.75;
const depthOf = new Map();
let all = false, unfolded = false, only = null, drawnFor = null;
const view = { x: 0, y: 0, scale: 1 };
const shape = (state) => graph.states[state][0];
(function survey() {
  const depth = [0], todo = [0];
  for (const state of todo) {
    const words = shape(state), flat = graph.states[state][2];
    if (!depthOf.has(words)) depthOf.set(words, depth[state]);
    for (let i = 2; i < flat.length; i += 3) {
      if (flat[i] >= 0 && depth[flat[i]] === undefined) { depth[flat[i]] = depth[state] + 1; todo.push(flat[i]); }
    }
  }
})();

// What is next: of every shape that a step leads to under the readings that are on, the steps; and what leads nowhere.
function nextShapes(frame) {
  const next = new Map();
  let stays = 0, beyond = 0;
  for (const move of moves(frame.state).filter((one) => allowed(frame, one.effect))) {
    if (move.to === HERE) stays += 1;
    else if (move.to === BEYOND) beyond += 1;
    else next.set(shape(move.to), [...(next.get(shape(move.to)) || []), move]);
  }
  return { next, stays, beyond };
}
const called = (doing) => (doing.kind === "call" ? doing.group : doing.words);
function ways(some) {
  const names = [...new Set(some.map((move) => called(move.doing)))];
  return names.slice(0, 2).join(", ") + (names.length > 2 ? ` and ${names.length - 2} more` : "");
}
// How a way is painted: by a reading that every step of it assumes, or else by who takes it.
function painted(some) {
  const departs = (effect) => effect.assumes.some(([id, letters]) => [...letters].every((letter) => ambiguities.get(id).flagged.includes(letter)));
  if (some.every((move) => departs(move.effect))) return "departs";
  if (some.every((move) => move.effect.assumes.length)) return "assumed";
  return ["call", "drive", "itself"].find((kind) => some.some((move) => move.doing.kind === kind));
}
function assumedBy(some) {
  const keys = ({ effect }) => [...new Set(effect.assumes.map(([id]) => id))].map((id) => {
    const letters = effect.assumes.filter(([other]) => other === id).map(([, some]) => some).reduce(agrees);
    return `${id} = ${[...letters].join(" or ")}`;
  });
  return keys(some[0]).filter((key) => some.every((move) => keys(move).includes(key)));
}
const counted = (words) => `${graph.shapes[words]} state${graph.shapes[words] === 1 ? "" : "s"}`;
function card(kind, words, lines, onclick, title) {
  const note = lines.filter(Boolean).map((line) => made("small", {}, line));
  return made("button", { type: "button", class: `shape ${kind}`, onclick, disabled: !onclick, title: title || null, "data-shape": words }, made("b", {}, words), ...note);
}
function choose(words, some) {
  if (some.length === 1) return take(some[0].index);
  only = only === words ? null : words;
  show();
  if (only !== null) at("doings").scrollIntoView({ block: "nearest" });
}
function nextCard(words, some) {
  const readings = assumedBy(some);
  const under = readings.length ? `assumes ${readings.join(", ")}` : some.every((move) => move.effect.assumes.length) ? "each under a reading" : "";
  const found = card(`next ${painted(some)}`, words, [[(some.length > 1 ? `${some.length} ways: ` : "") + ways(some), under].filter(Boolean).join("; ")],
    () => choose(words, some), some.length > 1 ? "Show only what leads there." : "Go there.");
  found.setAttribute("aria-pressed", String(only === words));
  return found;
}
const pastCard = (index) => card("past", shape(trail[index].state), [], () => { gone = index; go(); }, "Go back there.");
function hereCard(frame, { stays, beyond }) {
  return card("here", shape(frame.state), [`you are here: one of ${counted(shape(frame.state))}`, stays ? `${stays} step${stays === 1 ? " changes" : "s change"} nothing` : "",
    beyond ? `${beyond} lead${beyond === 1 ? "s" : ""} beyond the bounds` : ""], null);
}

// Lines, between columns only, so that none crosses a node.
function svg(tag, attributes) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  return element;
}
function arrow(kind, path, [x, y]) {
  return [svg("path", { class: `way ${kind}`, d: path }), svg("path", { class: `tip ${kind}`, d: `M${x},${y}l-8,-4.5v9z` })];
}
function put(element, x, y, width) {
  [element.style.left, element.style.top, element.style.width] = [`${x}px`, `${y}px`, `${width}px`];
  return { x, y, width, height: element.offsetHeight, element };
}
function across(from, to, kind) {
  const [x, y, end, level] = [from.x + from.width, from.y + from.height / 2, to.x, to.y + to.height / 2];
  return arrow(kind, `M${x},${y}C${x + APART / 2},${y} ${end - APART / 2},${level} ${end - 6},${level}`, [end, level]);
}
function stacked(elements, x, width) {
  let y = 0;
  return elements.map((element) => {
    const placed = put(element, x, y, width);
    y += placed.height + BETWEEN;
    return placed;
  });
}
function lower(placed, by) {
  for (const one of placed) {
    one.y += by;
    one.element.style.top = `${one.y}px`;
  }
}
const bottom = (column) => (column.length ? column.at(-1).y + column.at(-1).height : 0);
function aside(before, here, next) {
  const columns = [...before.map((one) => [one]), [here], next];
  const placed = columns.map((column, i) => stacked(column, i * (WIDTH + APART), column === next ? NEXT_WIDTH : WIDTH));
  const height = Math.max(...placed.map(bottom));
  for (const column of placed) lower(column, (height - bottom(column)) / 2);
  const lines = placed.slice(1).flatMap((column, i) => column.flatMap((one) => across(placed[i][0], one, one.element.dataset.way || "past")));
  return { lines, width: (columns.length - 1) * (WIDTH + APART) + NEXT_WIDTH, height };
}
function below(before, here, next, width) {
  const indent = 26, spine = 12;
  const top = stacked([...before, here], 0, width - indent);
  const placed = stacked(next, indent, width - indent);
  lower(placed, bottom(top) + BETWEEN);
  const down = top.slice(1).map((one, i) => svg("path", { class: "way past", d: `M${spine},${bottom([top[i]])}V${one.y}` }));
  const branches = placed.flatMap((one) => {
    const level = one.y + one.height / 2;
    return arrow(one.element.dataset.way, `M${spine},${level}H${indent - 6}`, [indent, level]);
  });
  if (placed.length) down.push(svg("path", { class: "way past", d: `M${spine},${bottom(top)}V${placed.at(-1).y + placed.at(-1).height / 2}` }));
  return { lines: [...down, ...branches], width, height: bottom(placed.length ? placed : top) };
}
function around(frame, found, most) {
  const some = [...found.next].map(([words, leading]) => {
    const element = nextCard(words, leading);
    element.dataset.way = painted(leading);
    return element;
  });
  const more = some.length - MOST_NEXT;
  const next = unfolded || more <= 0 ? some : some.slice(0, MOST_NEXT - 1);
  if (next.length < some.length) {
    const rest = card("more", `${some.length - next.length} more shapes`, ["show them all"], () => { unfolded = true; show(); });
    rest.dataset.way = "drive";
    next.push(rest);
  }
  const shown = Math.min(gone, most);
  const before = Array.from({ length: shown }, (_, i) => pastCard(gone - shown + i));
  return [before, hereCard(frame, found), next];
}
// All shapes, in columns by how many steps they are away at least; what is next and what was before are painted.
function everything(frame, found) {
  const been = new Map(trail.slice(0, gone).map((one, i) => [shape(one.state), i]));
  const columns = [];
  for (const [words, depth] of depthOf) {
    const some = found.next.get(words);
    const index = been.get(words);
    const element = words === shape(frame.state) ? hereCard(frame, found) : some ? nextCard(words, some)
      : index !== undefined ? card("past", words, [counted(words)], () => { gone = index; go(); }, "Go back there.") : card("elsewhere", words, [counted(words)], null);
    (columns[depth] ||= []).push(element);
  }
  return columns.filter(Boolean);
}

function showMap(frame) {
  if (drawnFor !== `${frame.state} ${gone} ${path}`) [only, unfolded, drawnFor] = [null, false, `${frame.state} ${gone} ${path}`];
  const found = nextShapes(frame), stage = at("stage"), lines = svg("svg", { class: "ways", "aria-hidden": "true" });
  let size;
  if (all) {
    const columns = everything(frame, found);
    stage.replaceChildren(lines, ...columns.flat());
    const placed = columns.map((column, i) => stacked(column, i * (WIDTH + BETWEEN), WIDTH));
    size = { lines: [], width: columns.length * (WIDTH + BETWEEN) - BETWEEN, height: Math.max(...placed.map(bottom)) };
  } else {
    const room = at("map").clientWidth, narrow = room < NARROW;
    const [before, here, next] = around(frame, found, narrow ? 1 : MOST_BEFORE);
    stage.replaceChildren(lines, ...before, here, ...next);
    size = narrow ? below(before, here, next, room - 24) : aside(before, here, next);
  }
  lines.append(...size.lines);
  lines.setAttribute("width", size.width);
  lines.setAttribute("height", size.height);
  Object.assign(stage.dataset, { width: size.width, height: size.height });
  at("around").setAttribute("aria-pressed", String(!all));
  at("whole").setAttribute("aria-pressed", String(all));
  fit(all ? READABLE : 0);
}

// Pan and zoom.
function look() {
  at("stage").style.transform = `translate(${view.x}px, ${view.y}px) scale(${view.scale})`;
}
// Of what is larger than its room no side is left empty.
const inside = (start, size, room) => Math.min(12, Math.max(start, room + 12 - size));
// What is around fits whole, in as much height as it takes; all shapes are a map to move about in.
function fit(least = 0) {
  const map = at("map"), stage = at("stage").dataset, room = map.clientWidth - 24;
  const tallest = all ? Math.min(window.innerHeight * 0.6, 620) - 24 : Infinity;
  view.scale = Math.max(least, Math.min(1, room / stage.width, tallest / stage.height));
  const [width, height] = [stage.width * view.scale, stage.height * view.scale];
  map.style.height = `${Math.min(height, tallest) + 26}px`;
  const here = at("stage").querySelector(".here");
  const middle = [here.offsetLeft + here.offsetWidth / 2, here.offsetTop + here.offsetHeight / 2];
  view.x = width > room ? inside(map.clientWidth / 2 - middle[0] * view.scale, width, room) : 12 + (room - width) / 2;
  view.y = height > tallest ? inside(tallest / 2 + 13 - middle[1] * view.scale, height, tallest) : 12;
  look();
}
function zoom(factor, x = at("map").clientWidth / 2, y = at("map").clientHeight / 2) {
  const scale = Math.min(3, Math.max(0.15, view.scale * factor));
  view.x = x - ((x - view.x) * scale) / view.scale;
  view.y = y - ((y - view.y) * scale) / view.scale;
  view.scale = scale;
  look();
}
function pan(x, y) {
  view.x += x;
  view.y += y;
  look();
}
const fingers = new Map();
at("map").addEventListener("pointerdown", (event) => fingers.set(event.pointerId, event));
addEventListener("pointermove", (event) => {
  const before = fingers.get(event.pointerId);
  if (!before) return;
  const [one, other] = [...fingers.values()];
  fingers.set(event.pointerId, event);
  if (!other) return pan(event.clientX - before.clientX, event.clientY - before.clientY);
  const apart = (a, b) => Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
  const still = one.pointerId === event.pointerId ? other : one, box = at("map").getBoundingClientRect();
  zoom(apart(event, still) / (apart(before, still) || 1), still.clientX - box.left, still.clientY - box.top);
});
for (const end of ["pointerup", "pointercancel"]) addEventListener(end, (event) => fingers.delete(event.pointerId));
at("map").addEventListener("wheel", (event) => {
  if (!event.ctrlKey && !event.metaKey) return;  // the page scrolls
  event.preventDefault();
  const box = at("map").getBoundingClientRect();
  zoom(Math.exp(-event.deltaY / 300), event.clientX - box.left, event.clientY - box.top);
}, { passive: false });
const KEYS = { ArrowLeft: [40, 0], ArrowRight: [-40, 0], ArrowUp: [0, 40], ArrowDown: [0, -40] };
at("map").addEventListener("keydown", (event) => {
  if (event.key in KEYS) pan(...KEYS[event.key]);
  else if (event.key === "+" || event.key === "-") zoom(event.key === "+" ? 1.25 : 0.8);
  else return;
  event.preventDefault();
});
at("nearer").addEventListener("click", () => zoom(1.25));
at("farther").addEventListener("click", () => zoom(0.8));
at("fit").addEventListener("click", () => fit());
for (const [id, wanted] of [["around", false], ["whole", true]]) at(id).addEventListener("click", () => { all = wanted; show(); });
addEventListener("resize", () => showMap(trail[gone]));
