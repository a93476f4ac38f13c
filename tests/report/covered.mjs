// Coverage of invented sources, as FORMAT.md describes it.

export const at = (tick, recording = 'Walk.mcap') => ({ recording, tick, time: tick < 0 ? null : tick / 1000 });

export function covered(line, first, { name = 'Walk::control()', ways = [], recordings = first ? 1 : 0 } = {}) {
  return { line, function: name, recordings, first, ways: ways.map((one) => ({ known: true, ...one })) };
}

export function coverage_of(files, more = {}) {
  const lines = files.flatMap((file) => file.lines);
  const executed = lines.filter((line) => line.first).length;
  return {
    verdict: `${executed} of ${lines.length} lines are executed by 1 recording`,
    lines: lines.length,
    lines_executed: executed,
    recordings: ['Walk.mcap'],
    files: files.map((file) => ({ source: null, unread: '', ...file })),
    failure: null,
    remarks: [],
    ...more,
  };
}

// 12 lines: 3 is executed before the run, 6 branches one way, 7 and 8 never run, nor does 12.
export const walk = {
  file: '/home/me/walk.cpp',
  source: [
    '// walks',
    '',
    'Walk::Walk() {}',
    '',
    'bool Walk::control() {',
    '  if (q > 0.5 && dq < limit<double>()) {',
    '\tlog("</script><script>document.title=\'hit\'</script>");',
    '    &amp;fall();',
    '  }',
    '  return true;',
    '}',
    'void Walk::stop() { <b>bold</b> }',
  ],
  lines: [
    covered(3, at(-1), { name: 'Walk::Walk()' }),
    covered(5, at(0)),
    covered(6, at(640), {
      ways: [{ first: at(640) }, { first: null }, { first: null, known: false }, { first: at(641) }],
    }),
    covered(7, null),
    covered(8, null),
    covered(10, at(1400), { ways: [{ first: at(1400) }, { first: null, known: false }] }),
    covered(12, null, { name: 'Walk::stop()' }),
  ],
};
