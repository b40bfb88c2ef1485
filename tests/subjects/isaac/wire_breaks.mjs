// The breaks that both ends of a mission connection share: how a line is written.

export const WIRE_BREAKS = {
  'json-over-several-lines': 'JsonTcpClient Codelet: a message contains newlines, which separate messages',
  'envelope-missing': 'JsonTcpClient Codelet: a message is sent bare, without header and payload',
  'payload-integers-bare': "JsonTcpClient Codelet: the halves of the payload's UUID are numbers, not strings",
  'header-integers-bare': "JsonTcpClient Codelet: the header's pubtime is a number, not a string",
};

/** The line as a broken subject would send it. */
export function lineAsSent(line, broken) {
  const { header, payload } = JSON.parse(line);
  if (broken('json-over-several-lines')) return JSON.stringify({ header, payload }, null, 2);
  if (broken('envelope-missing')) return JSON.stringify(payload);
  if (broken('payload-integers-bare')) return joined(header, bare(payload, 'lower', 'upper'));
  if (broken('header-integers-bare')) return joined(bare(header, 'pubtime'), payload);
  return line;
}

/** Values given as text are already JSON. */
function joined(header, payload) {
  const text = (part) => (typeof part === 'string' ? part : JSON.stringify(part));
  return `{"header":${text(header)},"payload":${text(payload)}}`;
}

function bare(part, ...keys) {
  return JSON.stringify(part).replace(new RegExp(`"(${keys.join('|')})":"(\\d+)"`, 'g'), '"$1":$2');
}
