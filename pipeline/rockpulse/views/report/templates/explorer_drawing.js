"use strict";
// What the part to explore draws: curves in time, a body on the ground, the probability over the factor.
const explorerDrawing = (() => {
  const LEFT = 48, RIGHT = 8; // the room beside the curves, in pixels
  const SIXTEEN_BITS = -32768; // stands for no value

  // Extremes as they are packed: all minima, then all maxima of columns of one width.
  const unpacked = (packed) => {
    const bytes = Uint8Array.from(atob(packed.data), (letter) => letter.charCodeAt(0));
    const values = new DataView(bytes.buffer), count = bytes.length / 4;
    const read = (index) => {
      const whole = values.getInt16(2 * index, true);
      return whole === SIXTEEN_BITS ? null : whole * packed.scale;
    };
    const columns = (first) => Array.from({ length: count }, (_, column) => read(first + column));
    return { low: columns(0), high: columns(count) };
  };
  const middle = (curve, column) => (curve.low[column] === null ? null : (curve.low[column] + curve.high[column]) / 2);
  // The value between two columns; the last one before there is none lasts until then.
  const between = (curve, where) => {
    const last = curve.low.length - 1, below = Math.min(Math.floor(where), last);
    const one = middle(curve, below), other = middle(curve, Math.min(below + 1, last));
    return one === null || other === null ? one : one + (other - one) * (where - below);
  };
  const peakOf = (curve) => {
    const largest = (values, sign) => values.reduce((most, one) => Math.max(most, sign * (one ?? 0)), 0);
    return Math.max(largest(curve.high, 1), largest(curve.low, -1));
  };

  const shape = (name, attributes, text) => {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const key in attributes) made.setAttribute(key, attributes[key]);
    if (text !== undefined) made.textContent = text;
    return made;
  };
  const emptied = (svg, height) => {
    const width = Math.max(svg.clientWidth || svg.parentNode.clientWidth, 200);
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    svg.style.height = `${height}px`;
    svg.replaceChildren();
    return width;
  };
  const joined = (points) => points.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join("L");
  // Round numbers, about so many, between two ends.
  const ticks = (start, end, about) => {
    const raw = (end - start) / about, power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((one) => one * power).find((one) => one >= raw);
    const found = [];
    for (let tick = Math.ceil(start / step); tick * step <= end; tick++) found.push(tick * step);
    return found;
  };

  // A curve in time, if there is one, as the outline of its extremes; marks are levels with a label and perhaps a line.
  const curve = (svg, scene, extremes, { height, reach, kind, title, marks, seconds }) => {
    const width = emptied(svg, height), top = 16, foot = height - 16, half = (foot - top) / 2, zero = top + half;
    const x = (column) => LEFT + ((column + 0.5) / scene.columns) * (width - LEFT - RIGHT);
    const y = (value) => zero - (Math.max(-reach, Math.min(reach, value)) / reach) * half;
    svg.append(shape("text", { x: LEFT, y: 10 }, title));
    svg.append(shape("path", { class: "axis", d: `M${LEFT} ${zero}H${width - RIGHT}M${LEFT} ${top}V${foot}` }));
    for (const [value, label, line] of marks) {
      if (line) svg.append(shape("path", { class: line, d: `M${LEFT} ${y(value)}H${width - RIGHT}` }));
      svg.append(shape("text", { x: LEFT - 5, y: y(value) + 4, "text-anchor": "end" }, label));
    }
    for (const time of ticks(scene.start, scene.end, width / 90)) {
      const at = LEFT + ((time - scene.start) / (scene.end - scene.start)) * (width - LEFT - RIGHT);
      svg.append(shape("path", { class: "axis", d: `M${at} ${foot}v4` }));
      svg.append(shape("text", { x: at, y: height - 1, "text-anchor": "middle" }, seconds(time)));
    }
    if (extremes) {
      // The curve ends where the body has fallen, or leaves the picture on its way down.
      const ends = (_, column) => extremes.low[column] === null || Math.abs(middle(extremes, column)) > reach;
      const last = extremes.low.findIndex(ends), count = last < 0 ? extremes.low.length : last;
      const along = (values) => values.slice(0, count).map((value, column) => [x(column), y(value)]);
      const outline = [...along(extremes.high), ...along(extremes.low).reverse()];
      if (count) svg.append(shape("path", { class: kind, d: `M${joined(outline)}Z` }));
      if (count && last > 0) {
        const [cx, cy] = [x(count - 1), y(middle(extremes, count - 1))];
        svg.append(shape("path", { class: "fallen", d: `M${cx - 5} ${cy - 5}l10 10m0 -10l-10 10` }));
      }
    }
    const now = shape("path", { class: "now" });
    svg.append(now);
    return { move: (where) => now.setAttribute("d", `M${x(where)} ${top}V${foot}`) };
  };

  // A body on the ground, with room for it to fall to either side, and an arrow below for the push of the ground.
  const stage = (svg, body, push) => {
    const width = svg.clientWidth || 300, height = svg.clientHeight || 200;
    const xs = body.outline.map((point) => point[0]);
    const left = Math.min(...xs), right = Math.max(...xs), top = Math.max(...body.outline.map((point) => point[1]));
    const scale = Math.min(width / (right - left + 2.1 * top), height / (1.3 * Math.hypot(top, right - left)));
    const base = 0.84 * height, below = 0.93 * height, centre = width / 2 - (scale * (left + right)) / 2;
    const x = (value) => centre + scale * value, y = (value) => base - scale * value;
    const outline = `M${joined(body.outline.map(([a, b]) => [x(a), y(b)]))}Z`;
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    svg.replaceChildren(shape("path", { class: "soil", d: `M8 ${base}H${width - 8}` }));
    if (body.wall) {
      const wall = { x: x(left) - 14, y: y(1.15 * top), width: 14, height: 1.15 * top * scale };
      svg.append(shape("rect", { class: "wall", ...wall }));
    }
    const moving = shape("g", {}), block = shape("path", { class: "block", d: outline });
    moving.append(block, shape("circle", { class: "mass", cx: x(0), cy: y(body.centre), r: 3 }));
    const arrow = shape("path", { class: "push" });
    svg.append(shape("path", { class: "upright", d: outline }), moving, arrow);
    svg.append(shape("text", { x: 10, y: below + 4 }, push));
    return {
      // A positive angle [degrees] is one about the right-hand corner, to the right; the share is that of the arrow.
      move: (angle, kind, share) => {
        moving.setAttribute("transform", `rotate(${angle} ${x(angle > 0 ? right : left)} ${base})`);
        block.setAttribute("class", `block ${kind}`);
        const length = 0.3 * width * share, head = Math.sign(length) * Math.min(7, Math.abs(length));
        const drawn = `M${width / 2} ${below}h${length}m${-head} -5l${head} 5l${-head} 5`;
        arrow.setAttribute("d", Math.abs(length) < 1 ? "" : drawn);
      },
    };
  };

  // The probability of overturning over the factor, as a curve or as single points, and the steps of the slider on it.
  const chance = (svg, scene, at, times) => {
    const height = 150, width = emptied(svg, height), top = 10, foot = height - 18;
    const factors = scene.steps.map((one) => one.factor);
    const first = Math.min(0.25, factors[0] / 1.3), last = Math.max(4, factors[factors.length - 1] * 1.3);
    const inside = ([factor]) => factor >= first && factor <= last;
    const x = (factor) => LEFT + (Math.log(factor / first) / Math.log(last / first)) * (width - LEFT - RIGHT);
    const y = (share) => foot - share * (foot - top);
    const dot = (factor, share, kind, radius) =>
      svg.append(shape("circle", { class: kind, cx: x(factor), cy: y(share), r: radius }));
    for (const share of [0, 0.5, 1]) {
      svg.append(shape("path", { class: "axis", d: `M${LEFT} ${y(share)}H${width - RIGHT}` }));
      svg.append(shape("text", { x: LEFT - 5, y: y(share) + 4, "text-anchor": "end" }, `${100 * share} %`));
    }
    for (const factor of [0.1, 0.2, 0.5, 1, 2, 5, 10, 20].filter((one) => inside([one]))) {
      svg.append(shape("path", { class: "axis", d: `M${x(factor)} ${foot}v4` }));
      svg.append(shape("text", { x: x(factor), y: height - 3, "text-anchor": "middle" }, times(factor)));
    }
    if (scene.curve) {
      const known = scene.curve[0].map((factor, place) => [factor, scene.curve[1][place]]).filter(inside);
      if (known.length) known.unshift([first, known[0][1]]);
      if (known.length) known.push([last, known[known.length - 1][1]]);
      const points = known.map(([factor, share]) => [x(factor), y(share)]);
      if (known.length) svg.append(shape("path", { class: "chance-line", d: `M${joined(points)}` }));
    } else {
      for (const [factor, share] of scene.points.filter(inside)) dot(factor, share, "known", 4);
    }
    svg.append(shape("path", { class: "now", d: `M${x(factors[at])} ${top}V${foot}` }));
    scene.steps.forEach(({ factor, probability }, place) => {
      if (probability !== null) dot(factor, probability, place === at ? "step current" : "step", place === at ? 6 : 4);
    });
  };

  return { LEFT, RIGHT, between, chance, curve, middle, peakOf, stage, unpacked };
})();
