// Takes the registry's addresses out of the lock file: versions and checksums stay, and every npm asks its own registry.
//   npm install --ignore-scripts && node strip-lock.mjs
import { readFileSync, writeFileSync } from 'node:fs';

const lock = JSON.parse(readFileSync('package-lock.json', 'utf8'));
for (const entry of Object.values(lock.packages)) {
  delete entry.resolved;
  delete entry.funding;
}
writeFileSync('package-lock.json', JSON.stringify(lock, null, 2) + '\n');
