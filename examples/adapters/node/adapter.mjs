// A robot in memory behind missionfsm's adapter protocol: put your own in its place.
// missionfsm conform bear.mission -- node examples/adapters/node/adapter.mjs

import { createInterface } from 'node:readline';

const DESTINATIONS = ['kitchen', 'table-1', 'table-2'];
const DECLARED = {
  implementation: { name: 'starter in JavaScript', version: '1' },
  drives: ['goalReached', 'missionFailed'],
  methods: ['CreateMission', 'AppendMission', 'SubscribeMissionStatus'],
  worlds: 'fixed',
  world: { family: 'base', destinations: DESTINATIONS },
  requests: 'binary', // nothing of a wrong type is sent: your gRPC library would not let it in either
};
const CODES = { INVALID_ARGUMENT: 3, FAILED_PRECONDITION: 9, METHOD_NOT_FOUND: -32601 };
const TYPES = { navigateMission: 'BASE_TYPE_NAVIGATE', navigateAutoMission: 'BASE_TYPE_NAVIGATE_AUTO' };
const ENDS = { goalReached: 'STATE_SUCCEEDED', missionFailed: 'STATE_FAILED' };

const missions = []; // in their order
const streams = new Map(); // each stream, with what it was shown last
let streamNumber = 0; // none comes twice, not even after a reset
let sequenceNumber = 0; // likewise

/** Where the mission that runs is: the first that has not ended; -1 if there is none. */
const current = () => missions.findIndex(({ state }) => !Object.values(ENDS).includes(state));

function isGoal({ destinationId, pose }) {
  const isFinite = (number) => Number.isFinite(Number(number));
  return pose ? Object.values(pose).every(isFinite) : DESTINATIONS.includes(destinationId);
}

function assign({ mission }, { first }) {
  const [kind, wanted] = Object.entries(mission?.baseMission ?? {})[0] ?? ['', {}];
  const goals = wanted.goals?.length ? wanted.goals : [wanted.goal ?? {}];
  if (!goals.every(isGoal)) {
    return refusal('INVALID_ARGUMENT', 'what is needed is a base mission, with goals that are on the map');
  }
  if (first && current() >= 0) {
    return refusal('FAILED_PRECONDITION', 'a mission is running or waiting');
  }
  if (!first && missions.length === 0) {
    return refusal('FAILED_PRECONDITION', 'there is no mission to append to');
  }
  const missionId = `mission-${missions.length + 1}`;
  missions.push({ missionId, state: 'STATE_DEFAULT', goals, missionType: { baseType: TYPES[kind] } });
  return { result: { missionId } };
}

function refusal(status, message) {
  return { error: { code: CODES[status], message, data: { status } } };
}

function drive({ event }) {
  const mission = missions[current()];
  if (mission) {
    mission.state = ENDS[event];
  }
  return { result: { happened: mission !== undefined } };
}

const ANSWERS = {
  initialize: () => ({ result: DECLARED }),
  reset() {
    missions.length = 0;
    streams.clear();
    return { result: {} };
  },
  settle: () => ({ result: {} }), // nothing is under way: what was caused has been written
  drive,
  cancel({ stream }) {
    streams.delete(stream);
    return { result: {} };
  },
  CreateMission: (params) => assign(params, { first: true }),
  AppendMission: (params) => assign(params, { first: false }),
  SubscribeMissionStatus() {
    streamNumber += 1;
    streams.set(streamNumber, '');
    return { result: { stream: streamNumber } };
  },
};

const write = (line) => process.stdout.write(`${JSON.stringify({ jsonrpc: '2.0', ...line })}\n`);

for await (const line of createInterface({ input: process.stdin })) {
  const { id, method, params } = JSON.parse(line);
  write({ id, ...(ANSWERS[method]?.(params) ?? refusal('METHOD_NOT_FOUND', `there is no ${method}`)) });
  if (current() >= 0) {
    missions[current()].state = 'STATE_RUNNING';
  }
  const missionStates = { missions, currentMissionIndex: current() };
  for (const [stream, shown] of streams) {
    if (shown !== JSON.stringify(missionStates)) {
      streams.set(stream, JSON.stringify(missionStates));
      const metadata = { timestamp: new Date().toISOString(), sequenceNumber: (sequenceNumber += 1) };
      write({ method: 'message', params: { stream, message: { metadata, missionStates } } });
    }
  }
}
