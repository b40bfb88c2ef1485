// The kinds of missions that can be asked for: how each is reported and how it goes through its goals.

/** How a mission uses its goals. */
export const ROUTE = {
  ONCE: 'once', // from the first to the last, then it has succeeded
  PATROL: 'patrol', // over and over, until its stop condition
  SELECT: 'select', // one of them: the first that nobody holds
  NONE: 'none', // a charge
};

export const FAMILIES = ['base', 'servi', 'carti'];

// [reported type, route, the field that holds the goals]
const NAVIGATE = (prefix) => ({
  navigateMission: [`${prefix}_NAVIGATE`, ROUTE.ONCE, 'goal'],
  navigateAutoMission: [`${prefix}_NAVIGATE_AUTO`, ROUTE.SELECT, 'goals'],
});

const BASE = { families: FAMILIES, typeField: 'baseType', feedbackField: 'baseFeedback' };
const SERVI = { families: ['servi'], typeField: 'serviType', feedbackField: 'serviFeedback' };
const CARTI = { families: ['carti'], typeField: 'cartiType', feedbackField: 'cartiFeedback' };

export const MISSION_KINDS = {
  baseMission: { ...BASE, members: NAVIGATE('BASE_TYPE') },
  serviMission: {
    ...SERVI,
    members: {
      deliveryMission: ['SERVI_TYPE_SERVING', ROUTE.ONCE, 'goals'],
      deliveryPatrolMission: ['SERVI_TYPE_SERVING_PATROL', ROUTE.PATROL, 'goals'],
      bussingMission: ['SERVI_TYPE_BUSSING', ROUTE.ONCE, 'goals'],
      bussingPatrolMission: ['SERVI_TYPE_BUSSING_PATROL', ROUTE.PATROL, 'goals'],
      ...NAVIGATE('SERVI_TYPE'),
    },
  },
  cartiMission: {
    ...CARTI,
    members: {
      traverseMission: ['CARTI_TYPE_TRAVERSE', ROUTE.ONCE, 'goals'],
      traversePatrolMission: ['CARTI_TYPE_TRAVERSE_PATROL', ROUTE.PATROL, 'goals'],
      ...NAVIGATE('CARTI_TYPE'),
    },
  },
};

// The page has no type for birthdays and hostings, so they are reported as unknown (AM-26 a).
export const WORKFLOW_KINDS = {
  serviWorkflow: {
    ...SERVI,
    members: {
      delivery: ['SERVI_TYPE_SERVING', ROUTE.ONCE, 'goals'],
      deliveryPatrol: ['SERVI_TYPE_SERVING_PATROL', ROUTE.PATROL, 'goals'],
      bussing: ['SERVI_TYPE_BUSSING', ROUTE.ONCE, 'goals'],
      bussingPatrol: ['SERVI_TYPE_BUSSING_PATROL', ROUTE.PATROL, 'goals'],
      birthday: ['SERVI_TYPE_UNKNOWN', ROUTE.ONCE, 'goal'],
      hosting: ['SERVI_TYPE_UNKNOWN', ROUTE.ONCE, 'goals'],
      hostingPatrol: ['SERVI_TYPE_UNKNOWN', ROUTE.PATROL, 'goals'],
    },
  },
  cartiWorkflow: {
    ...CARTI,
    members: {
      traverse: ['CARTI_TYPE_TRAVERSE', ROUTE.ONCE, 'goals'],
      traversePatrol: ['CARTI_TYPE_TRAVERSE_PATROL', ROUTE.PATROL, 'goals'],
    },
  },
};

/** What a ChargeRobot call asks for: no goals, and none of the documented types (AM-39). */
export const CHARGE = { route: ROUTE.NONE, goals: [], missionType: {}, feedbackField: null };
