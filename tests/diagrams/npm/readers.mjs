// Reads diagrams with the programs that they are written for, and says what those understood.
// Stdin: {"mermaid": {name: text}, "plantuml": …, "scxml": …, "xstate": …, "events": {name: [event]}}.
// Stdout: the same names, each with nodes and edges, or with where every event leads from every state.
import { createRequire } from "node:module";
import { text } from "node:stream/consumers";

const job = JSON.parse(await text(process.stdin));
const require = createRequire(import.meta.url);

async function mermaidReader() {
  const { JSDOM } = require("jsdom");
  globalThis.window = new JSDOM("<body></body>").window;
  globalThis.document = globalThis.window.document;
  const { default: mermaid } = await import("mermaid");
  return async (source) => {
    await mermaid.parse(source);
    const { type, db } = await mermaid.mermaidAPI.getDiagramFromText(source.replace(/^---\n.*?\n---\n/s, ""));
    const states = type === "stateDiagram";
    const nodes = [...(states ? db.getStates() : db.getVertices()).keys()];
    const edges = states
      ? db.getRelations().map((one) => [one.id1, one.id2, one.relationTitle])
      : db.getEdges().map((one) => [one.start, one.end, one.text]);
    return { type, nodes, edges };
  };
}

function plantumlReader() {
  const { parse } = require("plantuml-parser");
  return (source) => {
    const [{ elements }] = parse(source);
    const edges = elements.filter((one) => one.left !== undefined);
    return { edges: edges.map((one) => [one.left, one.right, one.label]) };
  };
}

/** Where every event leads from every state; `run` replays events from the start and says where that ends. */
async function walk(run, events) {
  const moves = {};
  const paths = new Map([[await run([]), []]]);
  for (const [state, path] of paths) {
    moves[state] = {};
    for (const event of events) {
      const after = await run([...path, event]);
      moves[state][event] = after;
      if (!paths.has(after)) paths.set(after, [...path, event]);
    }
  }
  return moves;
}

function scxmlReader() {
  const scxml = require("@scion-scxml/scxml");
  return async (source, events) => {
    const model = await new Promise((resolve, reject) =>
      scxml.documentStringToModel("chart.scxml", source, (error, made) => (error ? reject(error) : resolve(made))),
    );
    const run = (path) =>
      new Promise((resolve, reject) =>
        model.prepare((error, made) => {
          if (error) return reject(error);
          const interpreter = new scxml.core.Statechart(made);
          interpreter.start();
          for (const event of path) interpreter.gen(event);
          return resolve(interpreter.getConfiguration()[0]);
        }),
      );
    return walk(run, events);
  };
}

function xstateReader() {
  const { createActor, createMachine } = require("xstate");
  return (source, events) => {
    const machine = createMachine(JSON.parse(source));
    const run = (path) => {
      const actor = createActor(machine).start();
      for (const type of path) if (actor.getSnapshot().status === "active") actor.send({ type });
      return actor.getSnapshot().value;
    };
    return walk(run, events);
  };
}

const makers = { mermaid: mermaidReader, plantuml: plantumlReader, scxml: scxmlReader, xstate: xstateReader };
const found = {};
for (const [form, make] of Object.entries(makers)) {
  const read = await make();
  found[form] = {};
  for (const [name, source] of Object.entries(job[form])) {
    try {
      found[form][name] = await read(source, job.events[name] ?? []);
    } catch (error) {
      found[form][name] = { error: String(error) };
    }
  }
}
process.stdout.write(JSON.stringify(found), () => process.exit(0));
