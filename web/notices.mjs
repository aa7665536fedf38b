// Writes the notices of what the built page contains: the licence of every package that it is made of.
//   node notices.mjs dist/notices.txt
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

const [output] = process.argv.slice(2);
const wanted = ['.'];
const found = new Map();
while (wanted.length > 0) {
  const folder = wanted.pop();
  const about = JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8'));
  if (folder !== '.') found.set(about.name, `${about.name} ${about.version} (${about.license})\n\n${readFileSync(join(folder, 'LICENSE'), 'utf8').trim()}\n`);
  for (const name of Object.keys(about.dependencies ?? {})) {
    if (!found.has(name)) wanted.push(join('node_modules', name));
  }
}
const line = `\n${'-'.repeat(80)}\n\n`;
const head = 'The studio of Pliant (Apache-2.0) contains the packages below, under the licences that follow.\n';
writeFileSync(output, [head, ...[...found.keys()].sort().map((name) => found.get(name))].join(line));
