// A robot with the mission API of the Mission page, behind the adapter protocol.
//
// node bear_mission.mjs [--concurrent] [--break NAME | --list-breaks]

import { CATALOGUE, applyBroken } from './bear_mission/breaks.mjs';
import { DRIVE_NAMES, Subject } from './bear_mission/subject.mjs';
import { breaksFrom } from './breaks.mjs';
import { notify, serve } from './jsonrpc.mjs';

const CONCURRENT = '--concurrent';

const args = process.argv.slice(2);
applyBroken(breaksFrom(CATALOGUE, args.filter((arg) => arg !== CONCURRENT)));

const subject = new Subject((stream, message) => notify('message', { stream, message }));

await serve('bear.mission', {
  implementation: { name: 'bear_mission.mjs', version: '1' },
  drives: DRIVE_NAMES,
  concurrent: args.includes(CONCURRENT),
  handlers: subject.handlers(),
});
