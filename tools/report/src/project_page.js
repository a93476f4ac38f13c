// The script of a project's page. The server sends the whole state by WebSocket, at first and whenever it changes; the
// page asks by POST, with the token of its address.
{
  const at = (id) => document.getElementById(id);
  const token_key = 'rehearse-token';

  /** The token behind the # of the address, which it leaves; it stays with this tab. */
  const take_token = () => {
    const given = /^#token=([0-9a-f]+)$/.exec(location.hash)?.[1];
    if (given) {
      sessionStorage.setItem(token_key, given);
      history.replaceState(null, '', location.pathname);
    }
    return sessionStorage.getItem(token_key);
  };
  const token = take_token();

  let state = null;
  let chosen = ''; // the file of a scenario
  let shown_report = ''; // the scenario and the moment of the report in the frame
  let report_address = '';
  const rows = new Map(); // by file

  /** An element with attributes and children. */
  const make = (name, attributes = {}, ...children) => {
    const element = document.createElement(name);
    for (const [key, value] of Object.entries(attributes))
      if (key.startsWith('on')) element.addEventListener(key.slice(2), value);
      else if (value !== null && value !== false) element.setAttribute(key, value === true ? '' : value);
    element.append(...children);
    return element;
  };

  const tell = (text) => {
    at('build').textContent = text;
  };

  /** What the server answers; its error is shown, and is null here. */
  const ask = async (path, asked) => {
    try {
      const answer = await fetch(path, {
        method: 'POST',
        headers: { Authorization: `Bearer ${token}`, 'Content-Type': 'application/json' },
        body: JSON.stringify(asked),
      });
      if (answer.ok) return answer;
      const text = await answer.text();
      tell(answer.status === 409 ? JSON.parse(text).error : text);
    } catch {
      tell('rehearse ui has ended');
    }
    return null;
  };

  /** Asks a question in a dialog before something is decided. */
  const question = (title, text, answer, act) => {
    at('question-title').textContent = title;
    at('question-text').textContent = text;
    at('yes').textContent = answer;
    at('yes').onclick = () => {
      at('question').close();
      act();
    };
    at('question').showModal();
  };

  const seconds_text = (seconds) => (seconds < 10 ? `${seconds.toFixed(1)} s` : `${Math.round(seconds)} s`);
  const age_text = (moment) => {
    const seconds = Math.max(0, (Date.now() - moment) / 1000);
    if (seconds < 2) return 'now';
    if (seconds < 90) return `${Math.round(seconds)} s ago`;
    return seconds < 5400 ? `${Math.round(seconds / 60)} min ago` : `${Math.round(seconds / 3600)} h ago`;
  };

  const is_judged = (scenario) => scenario.result !== null;
  const state_of = (scenario) => scenario.result?.state ?? '';
  const is_waiting = (scenario) => state.waiting.some((run) => run.golden === scenario.golden);
  const mark_of = (scenario) => {
    if (scenario.phase === 'checking') return '… runs';
    if (!is_judged(scenario)) return '…';
    const word = { passed: '✓ passed', differs: '✕ differs', failed: '✕ failed', unjudged: '✕ not judged' };
    return word[state_of(scenario)];
  };

  /** A text in which places as hold.cpp:12 are buttons that open the editor. */
  const with_places = (text) => {
    if (!state.has_editor) return [text];
    const parts = [];
    let end = 0;
    for (const place of text.matchAll(/([\w./-]+\.(?:cpp|cc|cxx|c|h|hpp|rs|py|yaml|urdf|body)):(\d+)/g)) {
      const [words, file, line] = place;
      parts.push(text.slice(end, place.index));
      const open = () => ask('/open', { file, line: Number(line) });
      parts.push(make('button', { type: 'button', class: 'place', onclick: open }, words));
      end = place.index + words.length;
    }
    return [...parts, text.slice(end)];
  };

  const decision = (golden, is_accepted) => () =>
    question(
      is_accepted ? `Accept the run as golden ${golden}?` : `Discard the run of ${golden}?`,
      is_accepted
        ? 'It replaces the golden. Look at the differences first; git shows and undoes the change of its files.'
        : 'The run that waits is removed, and the golden stays as it is.',
      is_accepted ? 'Accept' : 'Discard',
      () => ask(is_accepted ? '/accept' : '/reject', { golden }),
    );
  const decisions = (golden) => [
    make('button', { type: 'button', class: 'primary', onclick: decision(golden, true) }, 'Accept…'),
    make('button', { type: 'button', onclick: decision(golden, false) }, 'Discard…'),
  ];

  const choose = (file) => {
    chosen = file;
    ask('/look', { file });
    show_rows();
    show_detail();
  };

  const row_of = (file) => {
    if (rows.has(file)) return rows.get(file);
    const mark = make('td', { class: 'mark' });
    const name = make('button', { type: 'button' });
    const sentence = make('small');
    const row = make('tr', { onclick: () => choose(file) }, mark, make('td', {}, name, sentence));
    row.addEventListener('keydown', (event) => {
      if (event.key === 'Enter' && event.target === row) choose(file);
    });
    rows.set(file, { row, mark, name, sentence });
    return rows.get(file);
  };

  const show_rows = () => {
    const files = state.scenarios.map(({ file }) => file);
    for (const [file, { row }] of rows)
      if (!files.includes(file)) {
        row.remove();
        rows.delete(file);
      }
    state.scenarios.forEach((scenario, i) => {
      const { row, mark, name, sentence } = row_of(scenario.file);
      if (at('scenarios').children[i] !== row) at('scenarios').insertBefore(row, at('scenarios').children[i] ?? null);
      const is_old = scenario.phase !== 'judged';
      row.className = `${state_of(scenario)} ${is_old ? 'old' : ''}`;
      row.toggleAttribute('data-finding', is_judged(scenario) && state_of(scenario) !== 'passed');
      row.setAttribute('aria-selected', String(scenario.file === chosen));
      name.setAttribute('aria-pressed', String(scenario.file === chosen));
      mark.textContent = mark_of(scenario);
      name.textContent = scenario.name;
      const { sentence: words = '', at: moment, closest } = scenario.result ?? {};
      const margin = closest && state_of(scenario) === 'passed' ? `margin ${(100 * closest.share).toPrecision(3)} %; ` : '';
      sentence.textContent = moment ? `${margin}${age_text(moment)}; ${words}` : '';
    });
    document.querySelector('.filtered input').dispatchEvent(new Event('input'));
  };

  const fact = (name, ...content) => (content.length ? [make('dt', {}, name), make('dd', {}, ...content)] : []);

  /** Shows the report of a failed check, at its first difference. */
  const show_report = async (scenario, place) => {
    const key = `${scenario.file} ${scenario.result.at}`;
    if (shown_report !== key) {
      const answer = await ask('/report', { file: scenario.file });
      if (!answer || chosen !== scenario.file) return;
      URL.revokeObjectURL(report_address);
      report_address = URL.createObjectURL(new Blob([await answer.text()], { type: 'text/html' }));
      shown_report = key;
    }
    const tick = scenario.result.first?.tick;
    const address = report_address + (tick === undefined ? '' : `#tick=${tick}`);
    // no same origin: the report can't ask this server
    place.replaceChildren(
      make('iframe', { title: `report of ${scenario.name}`, sandbox: 'allow-scripts allow-downloads', src: address }),
    );
  };

  const show_detail = () => {
    const scenario = state.scenarios.find(({ file }) => file === chosen);
    const detail = at('detail');
    if (!scenario) {
      const none = 'No scenario of this project names a golden or expects something.';
      detail.replaceChildren(make('p', { class: 'absence' }, state.scenarios.length ? 'Choose a scenario.' : none));
      detail.dataset.shown = '';
      return;
    }
    const shown = JSON.stringify([scenario, is_waiting(scenario), state.has_editor]);
    if (detail.dataset.shown === shown) return;
    detail.dataset.shown = shown;
    const { result } = scenario;
    const open = () => ask('/open', { file: scenario.file, line: result?.line ?? 1 });
    const levels = Object.entries(result?.levels ?? {}).map(([level, value]) => `${level} ${value.replaceAll('_', ' ')}`);
    const place = state.has_editor
      ? make('button', { type: 'button', class: 'place', onclick: open }, `${scenario.file}:${result?.line ?? 1}`)
      : scenario.file;
    const frame = make('div', { class: 'frame' });
    detail.replaceChildren(
      make('h2', {}, scenario.name),
      ...(result ? [make('p', { class: 'sentence' }, ...with_places(result.sentence))] : []),
      make(
        'dl',
        {},
        ...fact('file', place),
        ...(scenario.golden ? fact('golden', scenario.golden) : []),
        ...(levels.length ? fact('levels', levels.join(', ')) : []),
        ...(result?.closest ? fact('nearest bound', `${result.closest.text}: ${result.closest.margin}`) : []),
        ...(result?.not_proved ? fact('simulated, not proved', result.not_proved) : []),
        ...(result ? fact('took', seconds_text(result.seconds)) : []),
        ...(result?.remarks ?? []).flatMap((remark) => fact('note', ...with_places(remark))),
        ...(result?.told ? fact('it wrote', make('code', {}, ...with_places(result.told))) : []),
      ),
      ...(is_waiting(scenario) ? [make('p', { class: 'answers' }, ...decisions(scenario.golden))] : []),
      frame,
    );
    if (scenario.report) show_report(scenario, frame);
    else if (scenario.report_follows) frame.replaceChildren(make('p', { class: 'absence' }, 'Its report is being made …'));
    else frame.remove();
  };

  const show_build = () => {
    const { folder, state: now, seconds, line, output } = state.build;
    const words = {
      runs: `building ${folder}: ${line}`,
      waits: 'a build waits',
      failed: `the build of ${folder} failed: the verdicts below are of the code before`,
      done: folder ? `the build in ${folder} is up to date; it took ${seconds_text(seconds)}` : 'the project has no build: its controllers are taken as they are',
    };
    tell(state.allowed ? words[now] : 'nothing was built or checked');
    at('output').hidden = now !== 'failed';
    at('output').textContent = output;
    at('again').hidden = !state.allowed;
    at('allow').hidden = state.allowed;
    const build = folder ? `Its files are built by "cmake --build ${folder}" whenever they change, and checked by "rehearse check"` : 'It is checked by "rehearse check" whenever its files change';
    at('asks').textContent = `${build}, which loads its controllers. Both run code of this project, with all your rights. You are asked once for ${state.project}.`;
  };

  const show_head = () => {
    const judged = state.scenarios.filter(is_judged);
    const bad = judged.filter((scenario) => state_of(scenario) !== 'passed').length;
    const busy = state.build.state === 'runs' || state.scenarios.some(({ phase }) => phase !== 'judged');
    const name = state.project.replace(/.*\//, '');
    const words = bad > 0 ? `${bad} of ${judged.length} failed` : `${judged.length} of ${state.scenarios.length} passed`;
    const is_bad = bad > 0 || state.build.state === 'failed';
    document.querySelector('.verdict').className = `verdict ${is_bad ? 'beyond' : judged.length ? 'equal' : ''}`;
    document.querySelector('.verdict .state').textContent = state.build.state === 'failed' ? 'not built' : words;
    document.querySelector('.verdict h1').textContent = busy && state.allowed ? `${name} …` : name;
    document.title = `${is_bad ? '✕' : judged.length ? '✓' : '…'} ${name}`;
  };

  const show_waiting = () => {
    const of_tests = state.waiting.filter((run) => !state.scenarios.some(({ golden }) => golden === run.golden));
    at('others').hidden = of_tests.length === 0;
    at('waiting').replaceChildren(
      ...of_tests.map((run) => {
        const sentence = run.sentence || (run.is_first ? 'it would be the first' : '');
        return make('li', {}, make('span', {}, make('b', {}, run.golden), ' ', make('small', {}, sentence)), ...decisions(run.golden));
      }),
    );
  };

  const show = (text) => {
    state = JSON.parse(text);
    if (!state.scenarios.some(({ file }) => file === chosen)) chosen = '';
    const red = state.scenarios.find((scenario) => is_judged(scenario) && state_of(scenario) !== 'passed');
    if (!chosen && state.scenarios.length > 0) {
      chosen = (red ?? state.scenarios[0]).file;
      ask('/look', { file: chosen });
    }
    show_build();
    show_head();
    show_rows();
    show_waiting();
    show_detail();
  };

  const connect = () => {
    const socket = new WebSocket(`ws://${location.host}/?token=${token}`);
    socket.addEventListener('message', ({ data }) => show(data));
    socket.addEventListener('close', () => {
      tell('rehearse ui has ended');
      document.querySelector('.verdict').className = 'verdict';
      setTimeout(connect, 2000);
    });
  };

  document.addEventListener('DOMContentLoaded', () => {
    at('may').addEventListener('click', () => ask('/allow', {}));
    at('again').addEventListener('click', () => ask('/check', {}));
    at('no').addEventListener('click', () => at('question').close());
    if (!token) return tell('Open the address that rehearse ui has printed: it has the token that this one lacks.');
    connect();
    setInterval(() => state && show_rows(), 5000);
  });
}
