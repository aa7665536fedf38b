// Runs the tests of the page, or says why it cannot: exit status 77, or 1 where PLIANT_NO_SKIPS is set.
//   PLIANT_PROGRAM=build/release/apps/pliant/pliant PLIANT_WEB=build/release/web node web/test/run.mjs [page print ...]
import { spawnSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { join } from 'node:path';

function skip(why) {
  const fails = Boolean(process.env.PLIANT_NO_SKIPS);
  console.log(`${fails ? 'failed, because PLIANT_NO_SKIPS is set' : 'skipped'}: ${why}`);
  process.exit(fails ? 1 : 77);
}

const web = process.env.PLIANT_WEB ?? new URL('..', import.meta.url).pathname;
if (Number(process.versions.node.split('.')[0]) < 18) skip('node 18 or newer is needed');
const all = ['units', 'wire', 'page', 'simulate', 'keyboard', 'print', 'machine', 'front', 'tasks', 'prepare', 'resume', 'wizard', 'stranger', 'truth', 'axe', 'visual'];
const named = process.argv.length > 2 ? process.argv.slice(2) : all;
const browser = named.some((name) => name !== 'units');
for (const needed of browser ? ['playwright-core', 'axe-core'] : ['esbuild'])
  if (!existsSync(join(web, 'node_modules', needed))) skip(`npm has not fetched ${needed}`);
if (browser && !existsSync(process.env.PLIANT_CHROMIUM ?? '/usr/bin/chromium')) skip('chromium is not installed');
const tests = named.map((name) => new URL(`${name}_test.mjs`, import.meta.url).pathname);
const run = spawnSync(process.execPath, ['--test', '--test-concurrency=1', ...tests], { stdio: 'inherit', env: { ...process.env, PLIANT_WEB: web } });
process.exit(run.status ?? 1);
