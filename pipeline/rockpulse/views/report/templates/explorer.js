"use strict";
(() => {
  const root = document.getElementById("explorer");
  if (!root) return;
  const data = JSON.parse(root.dataset.motions);
  const { words, bodies, records } = data;
  const part = (name) => root.querySelector(`[data-part="${name}"]`);
  const fill = (text, fields = {}) => text.replace(/\{(\w+)\}/g, (_, name) => fields[name]);
  const language = document.documentElement.lang;
  const digits = (value, count) => value.toLocaleString(language, { minimumFractionDigits: count, maximumFractionDigits: count });
  const short = (value) => value.toLocaleString(language, { maximumSignificantDigits: 3 });
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  const GRAVITY = 9.80665;
  const LEFT = 48, RIGHT = 8; // the room beside the curves, in pixels
  const STEP = 0.1; // seconds of the two buttons

  // What is shown: a body, a record, its scene if there is one, which of its factors, and the time in columns.
  let body, record = -1, scene, at = 0, place = 0, playing = 0;

  // Extremes as Python packs them: all minima, then all maxima; null where there is no value.
  const unpacked = (packed) => {
    const bytes = Uint8Array.from(atob(packed.data), (letter) => letter.charCodeAt(0));
    const values = new DataView(bytes.buffer), count = bytes.length / 4;
    const read = (index) => { const whole = values.getInt16(2 * index, true); return whole === -32768 ? null : whole * packed.scale; };
    const column = (_, index) => read(index);
    return { low: Array.from({ length: count }, column), high: Array.from({ length: count }, (_, index) => read(count + index)) };
  };
  const middle = (curve, column) => (curve.low[column] === null ? null : (curve.low[column] + curve.high[column]) / 2);
  // The value between two columns; that of the last one before the body has fallen is null.
  const between = (curve, where) => {
    const below = Math.min(Math.floor(where), curve.low.length - 1);
    const one = middle(curve, below), other = middle(curve, Math.min(below + 1, curve.low.length - 1));
    return one === null || other === null ? one : one + (other - one) * (where - below);
  };
  const seconds = (where) => scene.start + ((where + 0.5) / scene.columns) * (scene.end - scene.start);

  const shape = (name, attributes, text) => {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const key in attributes) made.setAttribute(key, attributes[key]);
    if (text !== undefined) made.textContent = text;
    return made;
  };
  const canvas = (name, height) => {
    const svg = part(name), width = Math.max(svg.clientWidth || svg.parentNode.clientWidth, 200);
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    svg.style.height = `${height}px`;
    svg.replaceChildren();
    return [svg, width];
  };
  const ticks = (start, end, about) => {
    const raw = (end - start) / about, power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((one) => one * power).find((one) => one >= raw);
    const found = [];
    for (let tick = Math.ceil(start / step); tick * step <= end; tick++) found.push(tick * step);
    return found;
  };

  // A curve as the outline of its extremes, up to where it has none.
  const curve = (name, extremes, reach, height, kind, title, marks) => {
    const [svg, width] = canvas(name, height);
    const top = 16, foot = height - 16, half = (foot - top) / 2, zero = top + half;
    const x = (column) => LEFT + ((column + 0.5) / scene.columns) * (width - LEFT - RIGHT);
    const y = (value) => zero - (Math.max(-reach, Math.min(reach, value)) / reach) * half;
    svg.append(shape("text", { x: LEFT, y: 10 }, title));
    svg.append(shape("path", { class: "axis", d: `M${LEFT} ${zero}H${width - RIGHT}M${LEFT} ${top}V${foot}` }));
    for (const [value, label, kind] of marks) {
      if (kind) svg.append(shape("path", { class: kind, d: `M${LEFT} ${y(value)}H${width - RIGHT}` }));
      svg.append(shape("text", { x: LEFT - 5, y: y(value) + 4, "text-anchor": "end" }, label));
    }
    for (const time of ticks(scene.start, scene.end, width / 90)) {
      const where = LEFT + ((time - scene.start) / (scene.end - scene.start)) * (width - LEFT - RIGHT);
      svg.append(shape("path", { class: "axis", d: `M${where} ${foot}v4` }));
      svg.append(shape("text", { x: where, y: height - 1, "text-anchor": "middle" }, fill(words.seconds, { time: short(time) })));
    }
    if (extremes) {
      // The curve ends where the body has fallen, or leaves the picture on its way down.
      const ends = (column) => extremes.low[column] === null || Math.abs(middle(extremes, column)) > reach;
      const last = extremes.low.findIndex((_, column) => ends(column)), count = last < 0 ? extremes.low.length : last;
      const upper = [], lower = [];
      for (let column = 0; column < count; column++) {
        upper.push(`${x(column).toFixed(1)} ${y(extremes.high[column]).toFixed(1)}`);
        lower.push(`${x(column).toFixed(1)} ${y(extremes.low[column]).toFixed(1)}`);
      }
      if (count) svg.append(shape("path", { class: kind, d: `M${upper.join("L")}L${lower.reverse().join("L")}Z` }));
      if (count && last > 0) {
        const [cx, cy] = [x(count - 1), y(middle(extremes, count - 1))];
        svg.append(shape("path", { class: "fallen", d: `M${cx - 5} ${cy - 5}l10 10m0 -10l-10 10` }));
      }
    }
    const now = shape("path", { class: "now" });
    svg.append(now);
    return { svg, width, move: (where) => now.setAttribute("d", `M${x(where)} ${top}V${foot}`) };
  };

  let charts = [], ground, rotation, stage, strongest;
  const step = () => scene.steps[at];

  const drawStage = () => {
    const svg = part("stage"), width = svg.clientWidth || 300, height = svg.clientHeight || 200;
    const xs = body.outline.map((point) => point[0]), ys = body.outline.map((point) => point[1]);
    const [left, right, top] = [Math.min(...xs), Math.max(...xs), Math.max(...ys)];
    // Room for the fallen body on each side, and for the ground below.
    const wide = right - left + 2.1 * top, high = 1.3 * Math.hypot(top, right - left);
    const scale = Math.min(width / wide, height / high);
    const base = height - 0.16 * height, middle = width / 2 - (scale * (left + right)) / 2;
    const x = (value) => middle + scale * value, y = (value) => base - scale * value;
    const outline = `M${body.outline.map(([a, b]) => `${x(a)} ${y(b)}`).join("L")}Z`;
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    svg.replaceChildren(shape("path", { class: "soil", d: `M8 ${base}H${width - 8}` }));
    if (body.wall) svg.append(shape("rect", { class: "wall", x: x(left) - 14, y: y(1.15 * top), width: 14, height: 1.15 * top * scale }));
    svg.append(shape("path", { class: "upright", d: outline }));
    const push = shape("path", { class: "push" });
    const moving = shape("g", {}), block = shape("path", { class: "block", d: outline });
    moving.append(block, shape("circle", { class: "mass", cx: x(0), cy: y(body.centre), r: 3 }));
    svg.append(moving, push, shape("text", { x: 10, y: base + 0.09 * height + 4 }, words.push));
    stage = {
      move: (angle, kind, share) => {
        // theta > 0 turns about the right-hand corner, to the right.
        moving.setAttribute("transform", `rotate(${angle} ${x(angle > 0 ? right : left)} ${base})`);
        block.setAttribute("class", `block ${kind}`);
        const length = 0.3 * width * share, from = width / 2, level = base + 0.09 * height, head = Math.sign(length) * Math.min(7, Math.abs(length));
        push.setAttribute("d", Math.abs(length) < 1 ? "" : `M${from} ${level}h${length}m${-head} -5l${head} 5l${-head} 5`);
        svg.setAttribute("aria-label", fill(words.stage, { body: body.name, degrees: digits(Math.abs(angle), 1) }));
      },
    };
  };

  const drawChance = () => {
    const known = scene.curve !== null || scene.points.length > 0;
    part("probability").toggleAttribute("hidden", !known);
    part("caption").textContent = known ? words[scene.curve ? "curve" : "points"] : words.no_curve;
    if (!known) return;
    const height = 150, [svg, width] = canvas("probability", height), top = 10, foot = height - 18;
    const factors = scene.steps.map((one) => one.factor);
    const first = Math.min(0.25, factors[0] / 1.3), last = Math.max(4, factors[factors.length - 1] * 1.3);
    const x = (factor) => LEFT + (Math.log(factor / first) / Math.log(last / first)) * (width - LEFT - RIGHT);
    const y = (share) => foot - share * (foot - top);
    for (const share of [0, 0.5, 1]) {
      svg.append(shape("path", { class: "axis", d: `M${LEFT} ${y(share)}H${width - RIGHT}` }));
      svg.append(shape("text", { x: LEFT - 5, y: y(share) + 4, "text-anchor": "end" }, `${100 * share} %`));
    }
    for (const factor of [0.1, 0.2, 0.5, 1, 2, 5, 10, 20].filter((one) => one >= first && one <= last)) {
      svg.append(shape("path", { class: "axis", d: `M${x(factor)} ${foot}v4` }));
      svg.append(shape("text", { x: x(factor), y: height - 3, "text-anchor": "middle" }, fill(words.factor_value, { factor: short(factor) })));
    }
    if (scene.curve) {
      const inside = scene.curve[0].map((factor, k) => [factor, scene.curve[1][k]]).filter(([factor]) => factor >= first && factor <= last);
      const ends = [[first, 0], ...inside, [last, inside.length ? inside[inside.length - 1][1] : 0]];
      if (inside.length) ends[0][1] = inside[0][1];
      svg.append(shape("path", { class: "chance-line", d: `M${ends.map(([factor, share]) => `${x(factor).toFixed(1)} ${y(share).toFixed(1)}`).join("L")}` }));
    } else {
      for (const [factor, share] of scene.points) {
        if (factor >= first && factor <= last) svg.append(shape("circle", { class: "known", cx: x(factor), cy: y(share), r: 4 }));
      }
    }
    svg.append(shape("path", { class: "now", d: `M${x(step().factor)} ${top}V${foot}` }));
    scene.steps.forEach((one, index) => {
      if (one.probability !== null) svg.append(shape("circle", { class: index === at ? "step current" : "step", cx: x(one.factor), cy: y(one.probability), r: index === at ? 6 : 4 }));
    });
  };

  const peakOf = (extremes) => Math.max(0, ...extremes.high.filter((one) => one !== null), ...extremes.low.filter((one) => one !== null).map((one) => -one));

  const draw = () => {
    ground = unpacked(scene.ground);
    rotation = step().rotation ? unpacked(step().rotation) : null;
    strongest = peakOf(ground) || 1;
    const peak = (strongest * step().factor) / GRAVITY, largest = rotation ? peakOf(rotation) : 0;
    const reach = largest >= 0.3 ? Math.min(Math.max(1.15, 1.08 * largest), 1.6) : 1.3 * largest || 1.15;
    const limits = reach > 1 ? [[1, "α_c", "limit"], [-1, "−α_c", "limit"], [0, "0"]] : [[reach / 1.3, short(reach / 1.3)], [-reach / 1.3, `−${short(reach / 1.3)}`], [0, "0"]];
    const unit = ground.low[0] === null ? null : ground;
    charts = [
      curve("ground", unit, strongest, 120, "acceleration", words.ground, unit ? [[strongest, short(peak)], [-strongest, `−${short(peak)}`]] : []),
      curve("rotation", rotation, reach, 190, "angle", words.rotation, limits),
    ];
    drawStage();
    drawChance();
    tell();
    show();
  };

  // How the body is at the cursor, drawn and in words.
  const show = () => {
    for (const chart of charts) chart.move(place);
    const now = between(ground, place);
    const fields = { time: digits(seconds(place), 2), ground: now === null ? "-" : digits((now * step().factor) / GRAVITY, 2) };
    let angle = 0, kind = "", text = words.state_still;
    if (rotation) {
      let found = between(rotation, place);
      const fallen = found === null;
      for (let column = Math.floor(place); found === null && column >= 0; column--) found = middle(rotation, column);
      fields.side = body.wall ? words.away : found > 0 ? words.right : words.left;
      if (fallen) {
        angle = found > 0 ? 90 : -90;
        [kind, text] = ["down", words.state_fallen];
      } else if (Math.abs(found) > 5e-4) {
        angle = (found * (found > 0 || body.wall ? body.alpha[0] : body.alpha[1]) * 180) / Math.PI;
        kind = Math.abs(found) > 1 ? "beyond" : "";
        text = words.state;
        Object.assign(fields, { rotation: digits(Math.abs(found), 2), degrees: digits(Math.abs(angle), 1), verdict: kind ? words.beyond : words.rocking });
      }
    }
    const told = step().ends === "unresolved" || step().reason ? "" : fill(text, fields);
    stage.move(angle, kind, ((now ?? 0) / strongest) * (step().factor / scene.steps[scene.steps.length - 1].factor) ** 0.5);
    part("state").textContent = told;
    part("time").value = place;
    part("time").setAttribute("aria-valuetext", fill(words.seconds, { time: fields.time }));
  };

  // The factor and how the motion ends at it.
  const tell = () => {
    const { factor, label, probability, ends, reason, peak, overturning } = step();
    const share = probability === null ? "" : fill(words.probability, { share: short(100 * probability) });
    const told = [fill(words.factor_value, { factor: short(factor) }), label, share || (scene.points.length ? words.probability_unknown : "")].filter(Boolean);
    part("chosen").textContent = told.join(" · ");
    part("factor").setAttribute("aria-valuetext", told.join(", "));
    const key = ends === "overturns" && overturning !== undefined ? "overturns_by" : ends;
    part("verdict").textContent = reason ?? fill(words[key], { peak: peak === undefined ? "" : short(peak), time: overturning === undefined ? "" : digits(overturning, 2) });
    part("verdict").className = `verdict mark ${{ rest: "good", rocks: "fair", overturns: "bad" }[ends] ?? "unknown"}`;
    const last = rotation && middle(rotation, scene.columns - 1), whole = scene.end >= scene.whole - 1e-6;
    const notes = [fill(words.stretch, { start: digits(scene.start, 1), end: digits(scene.end, 1), whole: digits(scene.whole, 1) })];
    if (rotation && whole && last !== null && Math.abs(last) > 0.01) notes.push(words.still_moving);
    if (body.held) notes.push(words.held);
    if (scene.remark) notes.push(`${scene.remark}.`);
    part("notes").textContent = notes.join(" ");
  };

  const pause = () => {
    cancelAnimationFrame(playing);
    playing = 0;
    part("play").textContent = words.play;
    part("state").setAttribute("aria-live", "polite");
    if (scene?.steps) show();
  };
  const play = () => {
    if (calm.matches) return;
    const last = scene.columns - 1, rate = last / (scene.end - scene.start);
    if (place >= last) place = 0;
    part("play").textContent = words.pause;
    part("state").setAttribute("aria-live", "off"); // a reader would not keep up
    let before;
    const frame = (now) => {
      place = Math.min(place + ((now - (before ?? now)) / 1000) * Number(part("speed").value) * rate, last);
      before = now;
      show();
      if (place >= last) pause();
      else playing = requestAnimationFrame(frame);
    };
    playing = requestAnimationFrame(frame);
  };
  const go = (where) => {
    pause();
    place = Math.max(0, Math.min(scene.columns - 1, where));
    show();
  };
  const advance = (time) => go(place + (time / (scene.end - scene.start)) * scene.columns);

  const quoted = (text) => (/^[\w@%+=:,.\/~-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);
  const choose = () => {
    pause();
    scene = body.scenes.find((one) => one.record === record);
    const missing = part("missing"), fields = { body: body.name, record: records[record].id, reason: scene?.reason ?? "" };
    const stored = Boolean(scene?.steps);
    missing.hidden = stored;
    part("scene").hidden = !stored;
    if (!stored) {
      const kept = scene ? "" : [`rockpulse plot ${quoted(data.file)} rotation-history --record ${quoted(fields.record)} --block ${quoted(body.block)}`, body.case ? ` --case ${body.case}` : "", " --factor 1 -o rotation.png"].join("");
      missing.querySelector("p").textContent = fill(scene ? words.no_motion : words.not_stored, fields);
      missing.querySelector("pre").textContent = kept;
      missing.querySelector("pre").hidden = !kept;
      return;
    }
    at = Math.max(scene.steps.findIndex((one) => one.factor === 1), 0);
    part("factor").max = scene.steps.length - 1;
    part("factor").value = at;
    part("time").max = scene.columns - 1;
    place = 0;
    draw();
  };
  const option = (value, text) => Object.assign(document.createElement("option"), { value, textContent: text });
  const group = (label, options) => {
    const made = document.createElement("optgroup");
    made.label = label;
    made.append(...options);
    return made;
  };
  const listRecords = () => {
    const named = (row) => [records[row].id, records[row].words].filter(Boolean).join(" · ");
    const here = body.scenes.map((one) => option(one.record, `${one.why.join(", ")}: ${named(one.record)}`));
    const rows = new Set(body.scenes.map((one) => one.record));
    const others = records.map((_, row) => row).filter((row) => !rows.has(row)).map((row) => option(row, named(row)));
    const groups = [[words.stored_here, here], [words.not_stored_here, others]].filter((one) => one[1].length);
    part("record").replaceChildren(...groups.map((one) => group(...one)));
    if (!rows.has(record)) record = body.scenes.length ? body.scenes[0].record : Math.max(record, 0);
    part("record").value = record;
  };
  const pick = (index) => {
    body = bodies[index];
    listRecords();
    choose();
  };

  part("body").append(...bodies.map((one, index) => option(index, one.name)));
  part("body").addEventListener("change", (event) => pick(Number(event.target.value)));
  part("record").addEventListener("change", (event) => { record = Number(event.target.value); choose(); });
  part("factor").addEventListener("input", (event) => { at = Number(event.target.value); draw(); });
  part("time").addEventListener("input", (event) => go(Number(event.target.value)));
  part("play").addEventListener("click", () => (playing ? pause() : play()));
  part("back").addEventListener("click", () => advance(-STEP));
  part("forward").addEventListener("click", () => advance(STEP));
  for (const name of ["ground", "rotation"]) {
    const point = (event) => {
      const box = part(name).getBoundingClientRect();
      go(((event.clientX - box.left - LEFT) / (box.width - LEFT - RIGHT)) * scene.columns);
    };
    part(name).addEventListener("pointerdown", point);
    part(name).addEventListener("pointermove", (event) => { if (event.buttons) point(event); });
  }
  const quiet = () => {
    if (calm.matches) pause();
    part("play").hidden = part("speed").parentNode.hidden = calm.matches;
    part("reduced").hidden = !calm.matches;
  };
  calm.addEventListener("change", quiet);
  root.hidden = false;
  quiet();
  pick(0);
  let width = root.clientWidth;
  new ResizeObserver(() => {
    if (root.clientWidth !== width && scene?.steps) draw();
    width = root.clientWidth;
  }).observe(root);
})();
