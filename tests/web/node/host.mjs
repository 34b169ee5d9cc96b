// host.mjs: evaluates lines of JSON strings, each a JavaScript expression, and answers {value} or {error}, for node.py.
import { createInterface } from 'node:readline';
import { pathToFileURL } from 'node:url';

const root = pathToFileURL(`${process.argv[2]}/`);
/** Makes the exports of modules of the page global. */
globalThis.load = async (...names) => {
  for (const name of names) Object.assign(globalThis, await import(new URL(name, root)));
};
globalThis.complaints = [];
process.on('unhandledRejection', (error) => complaints.push(error?.stack ?? String(error)));

for await (const line of createInterface({ input: process.stdin })) {
  let answer;
  try {
    answer = { value: await (0, eval)(JSON.parse(line)) };
  } catch (error) {
    answer = { error: error?.stack ?? String(error) };
  }
  process.stdout.write(`${JSON.stringify(answer)}\n`);
}
process.exit(0);
