// The status stream of one robot: numbered events, each sent to whoever listens.

import { isDeepStrictEqual } from 'node:util';

const FIRST_NUMBER = 1;

export class Feed {
  /** `send(stream, message)` delivers; the first event tells how the robot is at its start. */
  constructor(send, states) {
    this.send = send;
    this.streams = new Set();
    this.recorded = 0;
    this.record(states);
  }

  /** A new event, unless nothing has changed since the last. */
  record(states) {
    if (!isDeepStrictEqual(states, this.latest?.missionStates)) {
      this.publish(states);
    }
  }

  publish(states) {
    this.latest = this.event(states);
    this.recorded += 1;
    this.deliver();
  }

  event(states) {
    const metadata = { timestamp: new Date().toISOString(), sequenceNumber: this.nextNumber() };
    // A copy: the robot goes on changing what it reported.
    return { metadata, missionStates: structuredClone(states) };
  }

  nextNumber() {
    return FIRST_NUMBER + this.recorded;
  }

  deliver() {
    this.streams.forEach((stream) => this.send(stream, this.latest));
  }

  /** The latest event comes at once, under the number that it was recorded with. */
  subscribe(stream) {
    this.streams.add(stream);
    this.send(stream, this.latest);
  }

  cancel(stream) {
    this.streams.delete(stream);
  }
}
