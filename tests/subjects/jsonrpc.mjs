// The line protocol of an adapter: JSON-RPC 2.0, one object a line, over stdin and stdout.
//
// A subject hands its handlers to `serve` and calls `notify` for what happens besides the answers.
// Nothing here knows any particular system.

const PROTOCOL_VERSION = 1;

const PARSE_ERROR = -32700;
const INVALID_REQUEST = -32600;
const METHOD_NOT_FOUND = -32601;
const INVALID_PARAMS = -32602;
const INTERNAL_ERROR = -32603;

const GRPC_CODES = {
  INVALID_ARGUMENT: 3,
  DEADLINE_EXCEEDED: 4,
  NOT_FOUND: 5,
  PERMISSION_DENIED: 7,
  FAILED_PRECONDITION: 9,
  INTERNAL: 13,
};

/** An error that the documents know: an observation, not a failure of the adapter. */
export class Refusal extends Error {
  constructor(status, message) {
    super(message);
    this.status = status;
  }

  toJSON() {
    return { code: GRPC_CODES[this.status], message: this.message, data: { status: this.status } };
  }
}

/** A request that the adapter protocol itself does not allow. */
export class ProtocolError extends Error {
  constructor(code, message) {
    super(message);
    this.code = code;
  }

  toJSON() {
    return { code: this.code, message: this.message };
  }
}

export function invalidParams(message) {
  return new ProtocolError(INVALID_PARAMS, message);
}

// A stream's first message must follow the answer that carries its number, so whatever is notified
// while a request is being handled waits here until the answer is out.
let held = null;

/** Tell the tester something that is not an answer. */
export function notify(method, params) {
  const notification = { jsonrpc: '2.0', method, params };
  if (held === null) {
    write(notification);
  } else {
    held.push(notification);
  }
}

/**
 * Answer requests, strictly in order, until the end of stdin.
 *
 * `handlers` maps a method to a function from params to a result (or a promise of one).
 * `initialize` is answered here; so is `settle`, for subjects that do everything they do before they answer.
 */
export async function serve(system, { implementation, drives, concurrent = false, handlers }) {
  const methods = new Map(
    Object.entries({
      initialize: (params) => initialize(system, params, { implementation, drives, concurrent }),
      settle: () => ({}),
      ...handlers,
    }),
  );
  // A tester that has gone away is no reason for a stack trace.
  process.stdout.on('error', () => process.exit());
  for await (const line of lines(process.stdin)) {
    await handle(line, methods);
  }
}

function initialize(system, params, declaration) {
  if (params?.protocolVersion !== PROTOCOL_VERSION || params.system !== system) {
    throw invalidParams(`this adapter speaks version ${PROTOCOL_VERSION} for ${system}`);
  }
  return declaration;
}

// Not node:readline: it also breaks lines at U+2028 and U+2029, which JSON strings may contain.
async function* lines(input) {
  let rest = '';
  for await (const chunk of input.setEncoding('utf8')) {
    const pieces = (rest + chunk).split('\n');
    rest = pieces.pop();
    yield* pieces;
  }
  yield rest;
}

async function handle(line, methods) {
  if (line.trim() === '') {
    return;
  }
  held = [];
  const answer = await respond(line, methods);
  if (answer !== null) {
    write(answer);
  }
  const waiting = held;
  held = null;
  waiting.forEach(write);
}

async function respond(line, methods) {
  let id = null;
  try {
    const request = parse(line);
    id = request.id;
    const result = await call(request, methods);
    return id === undefined ? null : { jsonrpc: '2.0', id, result };
  } catch (error) {
    return id === undefined ? null : { jsonrpc: '2.0', id, error: reported(error) };
  }
}

function parse(line) {
  let request;
  try {
    request = JSON.parse(line);
  } catch (error) {
    throw new ProtocolError(PARSE_ERROR, `not JSON: ${error.message}`);
  }
  if (request === null || typeof request !== 'object' || typeof request.method !== 'string') {
    throw new ProtocolError(INVALID_REQUEST, 'a request is an object with a method');
  }
  return request;
}

function call({ method, params }, methods) {
  if (!methods.has(method)) {
    throw new ProtocolError(METHOD_NOT_FOUND, `there is no method ${method}`);
  }
  return methods.get(method)(params);
}

function reported(error) {
  if (error instanceof Refusal || error instanceof ProtocolError) {
    return error;
  }
  console.error(error);
  return new ProtocolError(INTERNAL_ERROR, `the adapter failed: ${error.message}`);
}

function write(message) {
  process.stdout.write(`${JSON.stringify(message)}\n`);
}
