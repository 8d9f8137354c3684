// The 3D view: one WebGL surface draws every view of the page, and each shows the picture on a canvas of its own.
"use strict";
(() => {
  const figures = [...document.querySelectorAll("figure.view")];
  const surface = document.createElement("canvas");
  let regl;
  try {
    regl = createREGL({ canvas: surface, attributes: { antialias: false }, extensions: ["webgl_depth_texture"] });
  } catch {
    for (const figure of figures) figure.append("The 3D view needs WebGL, which this browser does not have.");
    return;
  }

  // ---- drawing ----

  const FIELD_OF_VIEW = 0.5;  // radians, from top to bottom
  const f = 1 / Math.tan(FIELD_OF_VIEW / 2);
  const frame = regl.framebuffer({ depthTexture: true });
  const drawPoints = regl({
    vert: `precision highp float;
      attribute vec3 place, color;
      uniform mat4 project;
      uniform vec3 size;
      uniform float diameter;
      varying vec3 tint;
      void main() {
        gl_Position = project * vec4(size * (place - 0.5), 1.0);
        gl_PointSize = clamp(diameter / gl_Position.w, 2.0, 64.0);
        tint = color;
      }`,
    frag: `precision mediump float;
      varying vec3 tint;
      void main() {
        if (length(gl_PointCoord - 0.5) > 0.5) discard;
        gl_FragColor = vec4(tint, 1.0);
      }`,
    attributes: { place: { buffer: regl.prop("places"), size: 3, normalized: true },
                  color: { buffer: regl.prop("colors"), size: 3, normalized: true } },
    uniforms: { project: regl.prop("project"), size: regl.prop("size"), diameter: regl.prop("diameter") },
    primitive: "points", count: regl.prop("count"), framebuffer: frame,
  });

  // A centreline lies inside of its tube: it is drawn where it would be on the side of the surface that is seen. Bridges are
  // hidden by what lies on them, and drawn nevertheless. Alpha 0 keeps a line from being shaded.
  const LINE_FLOATS = 10;
  const lineAttribute = (offset, size) =>
    ({ buffer: regl.prop("segments"), offset: 4 * offset, size, stride: 4 * LINE_FLOATS });
  const drawLines = regl({
    vert: `precision highp float;
      attribute vec3 start, end;
      attribute vec2 corner;
      attribute float radius, before;
      uniform mat4 project;
      uniform vec3 eye;
      uniform vec2 viewport;
      uniform float width;
      varying float along;
      vec4 on_surface(vec3 p) {
        vec3 sight = normalize(eye - p);
        float slant = length(cross(sight, normalize(end - start)));
        return project * vec4(p + 1.15 * radius / max(slant, 0.25) * sight, 1.0);
      }
      void main() {
        vec4 a = on_surface(start), b = on_surface(end);
        vec2 direction = (b.xy / b.w - a.xy / a.w) * viewport;
        direction /= max(length(direction), 1e-6);
        gl_Position = mix(a, b, corner.x);
        gl_Position.xy += vec2(-direction.y, direction.x) * corner.y * width / viewport * gl_Position.w;
        along = before + corner.x * distance(start, end);
      }`,
    frag: `precision highp float;
      uniform vec3 ink;
      uniform float dash;
      varying float along;
      void main() {
        if (dash > 0.0 && fract(along / dash) > 0.6) discard;
        gl_FragColor = vec4(ink, 0.0);
      }`,
    attributes: { start: lineAttribute(0, 3), end: lineAttribute(3, 3), corner: lineAttribute(6, 2),
                  radius: lineAttribute(8, 1), before: lineAttribute(9, 1) },
    uniforms: { project: regl.prop("project"), eye: regl.prop("eye"), viewport: regl.prop("viewport"),
                width: regl.prop("width"), ink: regl.prop("ink"), dash: regl.prop("dash") },
    depth: { enable: (_, { dash }) => dash === 0 }, count: regl.prop("vertices"), framebuffer: frame,
  });

  // Shades what lies behind its neighbours in the picture (eye-dome lighting, Boucheny 2009), so that points look like the
  // surface that they lie on.
  const shade = regl({
    vert: `attribute vec2 corner;
      varying vec2 at;
      void main() { at = 0.5 + 0.5 * corner; gl_Position = vec4(corner, 0.0, 1.0); }`,
    frag: `precision highp float;
      uniform sampler2D colors, depths;
      uniform vec2 step, range;
      uniform vec3 background;
      varying vec2 at;
      float distance_at(vec2 p) {
        float d = 2.0 * texture2D(depths, p).r - 1.0;
        return log2(2.0 * range.x * range.y / (range.x + range.y - d * (range.y - range.x)));
      }
      void main() {
        vec4 color = texture2D(colors, at);
        float here = distance_at(at), behind = 0.0;
        for (int i = 0; i < 8; ++i) {
          float angle = 0.785398 * float(i);
          behind += max(0.0, here - distance_at(at + step * vec2(cos(angle), sin(angle))));
        }
        bool is_background = texture2D(depths, at).r == 1.0 && color.a == 1.0;
        float light = color.a == 0.0 ? 1.0 : 0.2 + 0.8 * exp(-90.0 * behind);
        gl_FragColor = vec4(is_background ? background : light * color.rgb, 1.0);
      }`,
    attributes: { corner: [[-1, -1], [3, -1], [-1, 3]] },
    uniforms: { colors: frame, depths: () => frame.depthStencil, step: regl.prop("step"), range: regl.prop("range"),
                background: regl.prop("background") },
    depth: { enable: false }, count: 3,
  });

  // ---- small things ----

  const add = (a, b, factor = 1) => a.map((x, i) => x + factor * b[i]);
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [0, 1, 2].map((i) => a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]);
  const painter = document.createElement("canvas").getContext("2d");
  const colorOf = (text) => {  // of the style's variable, where it is the name of one
    painter.fillStyle = text.startsWith("--") ? getComputedStyle(document.body).getPropertyValue(text) : text;
    return [1, 3, 5].map((i) => parseInt(painter.fillStyle.slice(i, i + 2), 16));
  };

  const decode = ({ points, count }) => {
    const bytes = Uint8Array.from(atob(points), (c) => c.charCodeAt(0));
    const Kinds = bytes.length === 7 * count ? Uint8Array : Uint16Array;
    return { places: new Uint16Array(bytes.buffer, 0, 3 * count), kinds: new Kinds(bytes.buffer, 6 * count) };
  };

  const segmentsOf = (tubes, center, bridged) => {
    const numbers = [];
    for (const { line, radius } of tubes) {
      let before = 0;
      for (const [start, end, isBridged] of line) {
        const a = add(start, center, -1), b = add(end, center, -1);
        if (isBridged === bridged)
          for (const corner of [[0, -1], [1, -1], [1, 1], [0, -1], [1, 1], [0, 1]])
            numbers.push(...a, ...b, ...corner, radius, before);
        before += Math.hypot(...add(b, a, -1));
      }
    }
    return { segments: regl.buffer(new Float32Array(numbers)), vertices: numbers.length / LINE_FLOATS };
  };

  // ---- a view ----

  const KEYS = "arrows turn, shift and arrows move, plus and minus zoom, 0 goes back";
  const controls = (data, number) => `<div class="bar">
    <fieldset ${data.layers.length > 1 ? "" : "hidden"}><legend>Colours</legend>${data.layers.map(({ name }, i) =>
      `<label><input type="radio" name="layer${number}" value="${i}" ${i === data.start ? "checked" : ""}> ${name}</label>`).join("")}
    </fieldset>
    <label ${data.tubes.length ? "" : "hidden"}><input type="checkbox" checked> centrelines</label>
    <label ${data.tubes.length ? "" : "hidden"}>numbers of <select></select></label>
    <button type="button">reset</button></div>
    <div class="stage"><canvas tabindex="0" role="application" aria-label="3D view: ${KEYS}"></canvas>
    <output class="facts"></output></div>
    <figcaption>${data.note} Drag to turn, with shift or two fingers to move, wheel or pinch to zoom; or the keys: ${KEYS}.
    ${data.tubes.length ? "Click a tube for its numbers." : ""}
    ${data.tubes.some(({ line }) => line.some(([, , bridged]) => bridged)) ?
      "Dashed: bridged where the scanner saw nothing." : ""}</figcaption>`;

  const makeView = (figure, number) => {
    const data = JSON.parse(figure.querySelector("script").textContent);
    figure.insertAdjacentHTML("beforeend", controls(data, number));
    const [canvas, facts, select] = ["canvas", ".facts", "select"].map((name) => figure.querySelector(name));
    const { places, kinds } = decode(data);
    const placeBuffer = regl.buffer(places);
    const colorBuffer = regl.buffer({ usage: "dynamic", type: "uint8", length: 3 * data.count });
    const center = add(data.lo, data.size, 0.5);
    const reach = 0.5 * Math.hypot(...data.size);
    const lines = data.layers.map((_, i) => {
      const tubes = data.tubes.filter(({ layer }) => layer === Math.min(i, 1));
      return [segmentsOf(tubes, center, false), segmentsOf(tubes, center, true)];
    });
    const sides = [...data.size].sort((a, b) => a - b);
    const spacing = Math.sqrt(sides[1] * sides[2] / data.count);
    const pointers = new Map();  // that are down, with their places
    let layer = 0, chosen = -1, camera;

    const paint = () => {
      const background = colorOf("--panel");
      const { colors, tubes } = data.layers[layer];
      const ofKind = colors.map((text, kind) => {
        const color = colorOf(text);
        return chosen < 0 || tubes[kind] === chosen ? color : color.map((c, i) => 0.25 * c + 0.75 * background[i]);
      });
      const bytes = new Uint8Array(3 * data.count);
      kinds.forEach((kind, i) => bytes.set(ofKind[kind], 3 * i));
      colorBuffer.subdata(bytes);
      draw();
    };

    const fromCenter = (i) => data.size.map((size, axis) => size * (places[3 * i + axis] / 65535 - 0.5));
    const reset = () => {  // as near as all points are in the picture, with a margin
      camera = { around: -1.2, above: 0.85, distance: reach, target: [0, 0, 0] };
      const { right, upward, back } = look();
      const aspect = canvas.clientWidth / canvas.clientHeight;
      for (let i = 0; i < data.count; ++i) {
        const p = fromCenter(i);
        const off = Math.max(Math.abs(dot(p, right)) / aspect, Math.abs(dot(p, upward)));
        camera.distance = Math.max(camera.distance, dot(p, back) + 1.05 * f * off);
      }
    };

    const up = data.up;
    const ahead = Math.abs(up[0]) > 0.5 ? [0, 1, 0] : [1, 0, 0];
    const side = cross(up, ahead);
    const look = () => {
      const { around, above, distance, target } = camera;
      const level = add(ahead.map((x) => x * Math.cos(around)), side, Math.sin(around));
      const back = add(level.map((x) => x * Math.cos(above)), up, Math.sin(above));
      const right = add(side.map((x) => x * Math.cos(around)), ahead, -Math.sin(around));
      const upward = cross(back, right);
      const eye = add(target, back, distance);
      const range = [Math.max(0.01 * distance, distance - 3 * reach), distance + 3 * reach];
      const stretch = (range[0] + range[1]) / (range[0] - range[1]);
      const rows = [right.map((x) => x * f * canvas.clientHeight / canvas.clientWidth), upward.map((x) => x * f),
                    back.map((x) => x * stretch), back.map((x) => -x)];
      const project = [0, 1, 2].flatMap((i) => rows.map((row) => row[i]));
      project.push(...rows.map((row) => -dot(row, eye)));
      project[14] += 2 * range[0] * range[1] / (range[0] - range[1]);
      return { project, eye, right, upward, back, range };
    };

    const draw = () => {
      const finer = pointers.size ? devicePixelRatio : Math.max(2, devicePixelRatio);  // at rest with smooth edges
      const width = Math.round(canvas.clientWidth * finer), height = Math.round(canvas.clientHeight * finer);
      if (!width || !height) return;
      for (const target of [surface, canvas])
        if (target.width !== width || target.height !== height) [target.width, target.height] = [width, height];
      if (frame.width !== width || frame.height !== height) frame.resize(width, height);
      regl.poll();
      const { project, eye, range } = look();
      const byte = (text) => colorOf(text).map((x) => x / 255);
      regl.clear({ color: [0, 0, 0, 1], depth: 1, framebuffer: frame });
      drawPoints({ places: placeBuffer, colors: colorBuffer, count: data.count, project, size: data.size,
                   diameter: 0.65 * spacing * f * height });
      if (figure.querySelector("[type=checkbox]").checked)
        lines[layer].forEach(({ segments, vertices }, isBridged) => vertices && drawLines({
          segments, vertices, project, eye, viewport: [width, height], width: 1.5 * finer, ink: byte("--ink"),
          dash: isBridged * reach / 40 }));
      shade({ step: [finer / width, finer / height], range, background: byte("--panel") });
      canvas.getContext("2d").drawImage(surface, 0, 0);
    };

    const choose = (tube) => {
      chosen = tube;
      select.value = tube;
      facts.replaceChildren();
      if (tube >= 0) {
        const { name, color, facts: numbers } = data.tubes[tube];
        facts.innerHTML = `<b>${name}</b><dl>${numbers.map(([key, value]) => `<dt>${key}</dt><dd>${value}</dd>`).join("")}</dl>`;
        facts.firstChild.style.borderColor = color.startsWith("--") ? `var(${color})` : color;
      }
      paint();
    };

    const show = (number) => {
      layer = number;
      const shown = [...new Set(data.layers[layer].tubes)].filter((tube) => tube >= 0).sort((a, b) => a - b);
      select.replaceChildren(new Option("no tube", -1), ...shown.map((tube) => new Option(data.tubes[tube].name, tube)));
      choose(-1);
    };

    /// The tube of the nearest point around a place of the canvas, -1 where there is none.
    const tubeAt = (x, y) => {
      const { project: m } = look();
      const clip = (i, row) => data.size.reduce(
        (sum, size, axis) => sum + m[4 * axis + row] * size * (places[3 * i + axis] / 65535 - 0.5), m[12 + row]);
      let nearest = Infinity, tube = -1;
      for (let i = 0; i < data.count; ++i) {
        const w = clip(i, 3);
        if (w <= 0 || w >= nearest) continue;
        const dx = (0.5 + 0.5 * clip(i, 0) / w) * canvas.clientWidth - x;
        const dy = (0.5 - 0.5 * clip(i, 1) / w) * canvas.clientHeight - y;
        if (dx * dx + dy * dy < 36) [nearest, tube] = [w, data.layers[layer].tubes[kinds[i]]];
      }
      return tube;
    };

    // ---- mouse, touch and keys ----

    const turn = (dx, dy) => {
      camera.around -= dx;
      camera.above = Math.min(1.55, Math.max(-1.55, camera.above + dy));
      draw();
    };
    const move = (dx, dy) => {  // in pixels
      const { right, upward } = look();
      const metres = 2 * camera.distance / f / canvas.clientHeight;
      camera.target = add(add(camera.target, right, -dx * metres), upward, dy * metres);
      draw();
    };
    const zoom = (factor) => {
      camera.distance = Math.min(20 * reach, Math.max(0.02 * reach, camera.distance * factor));
      draw();
    };

    let moved = 0;
    canvas.addEventListener("pointerdown", (event) => {
      if (event.isTrusted) canvas.setPointerCapture(event.pointerId);
      if (!pointers.size) moved = 0;
      pointers.set(event.pointerId, [event.offsetX, event.offsetY]);
    });
    canvas.addEventListener("pointermove", (event) => {
      const last = pointers.get(event.pointerId);
      if (!last) return;
      const now = [event.offsetX, event.offsetY], [dx, dy] = [now[0] - last[0], now[1] - last[1]];
      moved += Math.hypot(dx, dy);
      const other = [...pointers].find(([id]) => id !== event.pointerId)?.[1];
      pointers.set(event.pointerId, now);
      if (other) {
        move(dx / 2, dy / 2);
        zoom(Math.hypot(last[0] - other[0], last[1] - other[1]) / Math.max(1, Math.hypot(now[0] - other[0], now[1] - other[1])));
      } else if (event.shiftKey || event.buttons & 6) move(dx, dy);
      else turn(0.008 * dx, 0.008 * dy);
    });
    canvas.addEventListener("pointerup", (event) => {
      if (!pointers.delete(event.pointerId) || pointers.size) return;
      if (moved < 5 && event.button === 0) choose(tubeAt(event.offsetX, event.offsetY));
      else draw();
    });
    canvas.addEventListener("pointercancel", (event) => { pointers.delete(event.pointerId); draw(); });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      if (figures.length > 1 && document.activeElement !== canvas) return;  // the page scrolls
      event.preventDefault();
      zoom(Math.exp(0.0015 * event.deltaY));
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => {
      const arrow = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
      if (arrow && event.shiftKey) move(-20 * arrow[0], -20 * arrow[1]);
      else if (arrow) turn(0.1 * arrow[0], 0.1 * arrow[1]);
      else if (event.key === "+" || event.key === "=") zoom(0.9);
      else if (event.key === "-") zoom(1 / 0.9);
      else if (event.key === "0") reset(), draw();
      else return;
      event.preventDefault();
    });
    for (const input of figure.querySelectorAll("[type=radio]")) input.addEventListener("change", () => show(+input.value));
    figure.querySelector("[type=checkbox]").addEventListener("change", draw);
    figure.querySelector("button").addEventListener("click", () => { reset(); draw(); });
    select.addEventListener("change", () => choose(+select.value));
    new ResizeObserver(draw).observe(canvas);
    reset();
    show(data.start);
    return paint;
  };

  const repaint = figures.map(makeView);
  const repaintAll = () => repaint.forEach((paint) => paint());
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", repaintAll);
  regl.on("restore", repaintAll);
})();
