// The ways in which the subject can be told to deviate from the page, one at a time. Each violates it under every
// reading that the project tolerates, or else it would prove nothing about an oracle that does not notice.

import { CALL_BREAKS } from './breaks/calls.mjs';
import { MISSION_BREAKS } from './breaks/missions.mjs';
import { REPORT_BREAKS } from './breaks/reports.mjs';

const BREAKS = { ...CALL_BREAKS, ...MISSION_BREAKS, ...REPORT_BREAKS };

/** Each break's name, and in one line where and how it violates the page. */
export const CATALOGUE = Object.fromEntries(Object.entries(BREAKS).map(([name, [line]]) => [name, line]));

/** Alters this process for good. */
export function applyBroken(broken) {
  for (const [name, [, apply]] of Object.entries(BREAKS)) {
    if (broken(name)) {
      apply();
    }
  }
}
