
(() => {
  'use strict';
  const root = document.documentElement;
  const svgSpace = document.querySelector('svg')?.namespaceURI;

  // ---- light or dark ------------------------------------------------------
  const system = matchMedia('(prefers-color-scheme: dark)');
  const isDark = () =>
    root.dataset.theme ? root.dataset.theme === 'dark' : system.matches;
  const theme = document.createElement('button');
  theme.className = 'theme';
  theme.type = 'button';
  const nameTheme = () => {
    theme.textContent = isDark() ? 'Light colours' : 'Dark colours';
  };
  theme.addEventListener('click', () => {
    root.dataset.theme = isDark() ? 'light' : 'dark';
    nameTheme();
  });
  system.addEventListener('change', nameTheme);
  nameTheme();
  document.body.prepend(theme);

  // ---- contents of one experiment are open beside a wide page --------------
  const parts = document.querySelectorAll('nav details');
  if (parts.length === 1 && matchMedia('(min-width:70rem)').matches)
    parts[0].open = true;

  // ---- series on and off --------------------------------------------------
  for (const item of document.querySelectorAll('.legend li')) {
    const button = document.createElement('button');
    button.type = 'button';
    button.setAttribute('aria-pressed', 'true');
    button.title = 'show or hide';
    button.append(...item.childNodes);
    item.append(button);
    const parts = item.closest('figure').querySelectorAll(
      '.panels .k' + item.dataset.k);
    button.addEventListener('click', () => {
      const on = button.getAttribute('aria-pressed') !== 'true';
      button.setAttribute('aria-pressed', String(on));
      for (const part of parts) part.classList.toggle('off', !on);
    });
  }

  // ---- films: one moment at a time -----------------------------------------
  for (const film of document.querySelectorAll('.panels[data-moment]')) {
    const panels = [...film.children], each = Number(film.dataset.moment);
    const last = Math.ceil(panels.length / each) - 1;
    if (last < 1) continue;
    const bar = document.createElement('p');
    bar.className = 'film';
    const play = document.createElement('button');
    play.type = 'button';
    const at = document.createElement('input');
    Object.assign(at, {type: 'range', min: 0, max: last, value: 0});
    at.setAttribute('aria-label', 'moment');
    bar.append(play, at);
    film.before(bar);
    let timer = 0;
    const show = (moment) => {
      at.value = moment;
      panels.forEach((panel, k) => {
        panel.style.display =
          Math.floor(k / each) === Number(at.value) ? '' : 'none';
      });
    };
    const run = (on) => {
      clearInterval(timer);
      timer = on ? setInterval(
        () => show(Number(at.value) === last ? 0 : Number(at.value) + 1),
        600) : 0;
      play.textContent = on ? 'Pause' : 'Play';
    };
    play.addEventListener('click', () => run(!timer));
    at.addEventListener('input', () => { run(false); show(at.value); });
    run(false);
    show(0);
  }

  // ---- the point next to the pointer --------------------------------------
  const tip = document.createElement('div');
  tip.className = 'tip';
  tip.hidden = true;
  document.body.append(tip);
  const ring = svgSpace && document.createElementNS(svgSpace, 'circle');
  const hide = () => {
    tip.hidden = true;
    ring?.remove();
  };

  const axis = (text) => {
    const [lo, hi, log, start, length] = text.split(' ').map(Number);
    return (place) => {
      const u = (place - start) / length;
      return log ? lo * Math.pow(hi / lo, u) : lo + u * (hi - lo);
    };
  };
  const show = (value) => {
    const size = Math.abs(value);
    return size === 0 ? '0' : size < 1e-3 || size >= 1e6 ?
      value.toExponential(2) : String(Number(value.toPrecision(3)));
  };

  // What can be read: marks, or where there are none the pieces of lines.
  const piecesOf = (svg) => {
    const pieces = [];
    for (const group of svg.querySelectorAll('.k')) {
      const aside = Number(group.dataset.dx || 0);
      const name = [...group.classList].find((c) => /^k\d+$/.test(c));
      const add = (from, to) => pieces.push({group, name, aside, from, to});
      for (const mark of group.querySelectorAll('.m,.o,.x')) {
        const box = mark.getBBox();
        const at = [box.x + box.width / 2, box.y + box.height / 2];
        add(at, at);
      }
      const line = group.querySelector('.l');
      if (!line) continue;
      const steps = line.getAttribute('d').match(/[ML][^ML]+/g) || [];
      let last = null;
      for (const step of steps) {
        const at = step.slice(1).split(' ').map(Number);
        if (step[0] === 'L' && last) add(last, at);
        last = at;
      }
    }
    // Lines between marks say nothing that the marks do not.
    const marked = new Set(pieces.filter((p) => p.from === p.to)
      .map((p) => p.name));
    return pieces.filter((p) => p.from === p.to || !marked.has(p.name));
  };

  // The point of a piece that is nearest.
  const nearest = (piece, at) => {
    const [x, y] = piece.from;
    const dx = piece.to[0] - x, dy = piece.to[1] - y;
    const long = dx * dx + dy * dy;
    const u = long === 0 ? 0 : Math.min(1, Math.max(0,
      ((at.x - x) * dx + (at.y - y) * dy) / long));
    return {piece, x: x + u * dx, y: y + u * dy};
  };

  for (const svg of document.querySelectorAll('.panels svg')) {
    const title = svg.querySelector('title');
    if (title) {  // its own tip would cover ours
      svg.setAttribute('aria-label', title.textContent);
      title.remove();
    }
    const panel = svg.querySelector('[data-x]');
    if (!panel) continue;
    const labels = svg.closest('figure').querySelectorAll('.legend li');
    const toX = axis(panel.dataset.x), toY = axis(panel.dataset.y);
    let pieces;
    const read = (event) => {
      pieces ??= piecesOf(svg);
      const scale = svg.getScreenCTM();
      const at = new DOMPoint(event.clientX, event.clientY)
        .matrixTransform(scale.inverse());
      let best = null, least = 24 / scale.a;
      for (const piece of pieces) {
        if (piece.group.classList.contains('off')) continue;
        const p = nearest(piece, at);
        const far = Math.hypot(p.x - at.x, p.y - at.y);
        if (far < least) [best, least] = [p, far];
      }
      if (!best) return hide();
      const {name, aside} = best.piece;
      const label = name && labels[Number(name.slice(1))];
      const x = toX(best.x - aside), y = toY(best.y);
      tip.textContent = [
        label ? label.textContent.trim() : '',
        (panel.dataset.xLabel || 'x') + ' = ' + show(x),
        (panel.dataset.yLabel || 'y') + ' = ' + show(y),
      ].filter(Boolean).join('\n');
      tip.hidden = false;
      ring.setAttribute('class', 'ring');
      ring.setAttribute('r', '6');
      ring.setAttribute('cx', best.x);
      ring.setAttribute('cy', best.y);
      svg.append(ring);
      const room = tip.getBoundingClientRect();
      tip.style.left = Math.max(4, Math.min(
        event.clientX + 14, innerWidth - room.width - 8)) + 'px';
      tip.style.top = Math.max(4, event.clientY - room.height - 12) + 'px';
    };
    svg.addEventListener('pointermove', read);
    svg.addEventListener('pointerdown', read);
    svg.addEventListener('pointerleave', hide);
  }
  addEventListener('scroll', hide, {passive: true});
  addEventListener('keydown', (event) => {
    if (event.key === 'Escape') hide();
  });

  // ---- paper shows everything ---------------------------------------------
  let closed = [];
  addEventListener('beforeprint', () => {
    hide();
    closed = [...document.querySelectorAll('footer details:not([open])')];
    for (const part of closed) part.open = true;
  });
  addEventListener('afterprint', () => {
    for (const part of closed) part.open = false;
  });
})();
