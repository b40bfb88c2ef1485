// What surrounds the robot, as the adapter protocol describes it.

import { invalidParams } from '../jsonrpc.mjs';
import { FAMILIES } from './kinds.mjs';

const DEFAULT_WORLD = {
  family: 'servi',
  contactDock: true,
  chargingLocation: true,
  destinations: ['table-1', 'table-2', 'table-3'],
  occupied: [],
  blocked: false,
};

const isBoolean = (value) => typeof value === 'boolean';
const isNames = (value) => Array.isArray(value) && value.every((name) => typeof name === 'string');

const IS_VALID = {
  family: (value) => FAMILIES.includes(value),
  contactDock: isBoolean,
  chargingLocation: isBoolean,
  destinations: isNames,
  occupied: isNames,
  blocked: isBoolean,
};

export function newWorld(fields = {}) {
  return { ...DEFAULT_WORLD, ...checked(fields, Object.keys(IS_VALID)) };
}

/** Changes the world in place; its robot's family is for life. */
export function changeWorld(world, fields) {
  Object.assign(world, checked(fields, Object.keys(IS_VALID).filter((field) => field !== 'family')));
}

function checked(fields, allowed) {
  for (const [field, value] of Object.entries(fields)) {
    if (!allowed.includes(field) || !IS_VALID[field](value)) {
      throw invalidParams(`the world cannot have ${field}: ${JSON.stringify(value)}`);
    }
  }
  return fields;
}
