// Runs the tests of the page, or says why it cannot: exit status 77.
//   PLIANT_PROGRAM=build/release/apps/pliant/pliant PLIANT_WEB=build/release/web node web/test/run.mjs [page print ...]
import { spawnSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { join } from 'node:path';

function skip(why) {
  console.log(`skipped: ${why}`);
  process.exit(77);
}

const web = process.env.PLIANT_WEB ?? new URL('..', import.meta.url).pathname;
if (Number(process.versions.node.split('.')[0]) < 18) skip('node 18 or newer is needed');
if (!existsSync(join(web, 'node_modules', 'playwright-core'))) skip('npm has not fetched playwright-core');
if (!existsSync(join(web, 'node_modules', 'axe-core'))) skip('npm has not fetched axe-core');
if (!existsSync(process.env.PLIANT_CHROMIUM ?? '/usr/bin/chromium')) skip('chromium is not installed');
const all = ['wire', 'page', 'print', 'machine', 'stranger', 'truth', 'axe'];
const named = process.argv.slice(2);
const tests = (named.length ? named : all).map((name) => new URL(`${name}_test.mjs`, import.meta.url).pathname);
const run = spawnSync(process.execPath, ['--test', '--test-concurrency=1', ...tests], { stdio: 'inherit', env: { ...process.env, PLIANT_WEB: web } });
process.exit(run.status ?? 1);
