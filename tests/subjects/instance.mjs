// The handlers of a subject whose state is one instance: `reset` makes a fresh one, calls and drives act on it.

import { invalidParams, notify, serve } from './jsonrpc.mjs';

/**
 * Serves a synchronous subject.
 *
 * - `create(world, notify)` makes a fresh instance;
 * - `calls` maps a method to `(instance, params) => result`;
 * - `drives` maps an event to `(instance, params) => happened`, or to an object of further result fields.
 */
export function serveInstances(system, { implementation, create, calls, drives }) {
  let instance = null;

  const reset = (params) => {
    instance = create(params?.world ?? {}, notify);
    return {};
  };
  const drive = (params) => {
    if (!Object.hasOwn(drives, params?.event)) throw invalidParams(`there is no drive ${params?.event}`);
    return outcomeOf(drives[params.event](instance, params));
  };
  const afterReset = (handler) => (params) => {
    if (instance === null) throw invalidParams('the first request after initialize must be reset');
    return handler(params ?? {});
  };
  const handlers = Object.entries({ drive, ...boundTo(() => instance, calls) });
  return serve(system, {
    implementation,
    drives: Object.keys(drives),
    handlers: { reset, ...Object.fromEntries(handlers.map(([method, handler]) => [method, afterReset(handler)])) },
  });
}

function boundTo(instance, calls) {
  return Object.fromEntries(
    Object.entries(calls).map(([method, call]) => [method, (params) => call(instance(), params)]),
  );
}

function outcomeOf(result) {
  return typeof result === 'boolean' ? { happened: result } : { happened: true, ...result };
}
