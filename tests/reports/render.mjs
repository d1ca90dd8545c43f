// Draws figures for renderers_test.py: a line of JSON for each picture with its
// colours and the warnings that came of it. Paths of SVGs come on stdin.
import fs from 'fs';
import {Resvg} from '@resvg/resvg-js';
import * as vega from 'vega';
import * as lite from 'vega-lite';

function colors(svg) {
  const {pixels} = new Resvg(svg, {background: 'white'}).render();
  const found = new Set();
  for (let k = 0; k < pixels.length; k += 4)
    found.add(pixels[k] << 16 | pixels[k + 1] << 8 | pixels[k + 2]);
  return [...found].flatMap(c => [c >> 16, c >> 8 & 255, c & 255]);
}

function logger(warnings) {
  const log = {level: () => log, error: add, warn: add, info: () => log,
               debug: () => log};
  function add(...words) {
    warnings.push(words.join(' '));
    return log;
  }
  return log;
}

async function draw(path) {
  const warnings = [];
  const spec = JSON.parse(fs.readFileSync(path.replace(/svg$/, 'vl.json')));
  const log = logger(warnings);
  const {spec: compiled} = lite.compile(spec, {logger: log});
  const view = new vega.View(vega.parse(compiled), {renderer: 'none',
                                                    logger: log});
  const svg = await view.toSVG();
  view.finalize();
  return {path, renderer: 'Vega-Lite', warnings, colors: colors(svg)};
}

for (const path of fs.readFileSync(0, 'utf8').split('\n')) {
  const svg = fs.readFileSync(path, 'utf8');
  const all = [{path, renderer: 'resvg', warnings: [], colors: colors(svg)},
               await draw(path)];
  for (const one of all) process.stdout.write(JSON.stringify(one) + '\n');
}
