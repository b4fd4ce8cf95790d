// The 3D view of an actuator: its surface in several states, turned, cut open and coloured by stretch.
(() => {
  "use strict";

  const GREY = [0.72, 0.72, 0.72];
  const RING_SIDES = 72;
  // Much of the light has no direction: colours are to be read off the bar.
  const AMBIENT = 0.7;
  const FIELD_OF_VIEW = 22;
  // From where it is looked at first, radians: in a narrow window more along its axis.
  const WIDE = { polar: 1.15, azimuth: 0.55 }, NARROW = { polar: 1.05, azimuth: 1.0 }, NARROW_ASPECT = 1.5;
  const TURN = Math.PI / 24, ZOOM = 1.15;

  // --- colours -------------------------------------------------------------------------------

  function palette(colours) {
    const rgb = colours.map((hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16) / 255));
    return (share) => {
      const at = Math.min(Math.max(share, 0), 1) * (rgb.length - 1), low = Math.min(Math.floor(at), rgb.length - 2);
      return [0, 1, 2].map((c) => rgb[low][c] + (at - low) * (rgb[low + 1][c] - rgb[low][c]));
    };
  }

  // --- rigid rings ---------------------------------------------------------------------------

  /** A ring about the axis, of a rectangle turned through an angle: all round, or its half behind the cut. */
  function ringGeometry(ring, half) {
    const inner = ring.inner_radius_mm, outer = inner + ring.height_mm, w = 0.5 * ring.width_mm;
    const corners = [[-w, inner], [w, inner], [w, outer], [-w, outer]];
    const outwards = [[0, -1], [1, 0], [0, 1], [-1, 0]];
    const points = [], directions = [];
    const at = ([x, r], angle) => [x, r * Math.cos(angle), r * Math.sin(angle)];
    const quad = (four, four_normals) => {
      for (const k of [0, 1, 2, 0, 2, 3]) {
        points.push(...four[k]);
        directions.push(...four_normals[k]);
      }
    };
    const begin = half ? Math.PI : 0, step = (half ? Math.PI : 2 * Math.PI) / RING_SIDES;
    for (let k = 0; k < RING_SIDES; k++) {
      const a = begin + k * step, b = a + step;
      for (let side = 0; side < 4; side++) {
        const one = corners[side], other = corners[(side + 1) % 4], out = outwards[side];
        quad([at(one, a), at(other, a), at(other, b), at(one, b)], [at(out, a), at(out, a), at(out, b), at(out, b)]);
      }
    }
    if (half)
      for (const angle of [Math.PI, 2 * Math.PI]) {
        const four = corners.map((corner) => at(corner, angle));
        quad(angle < 4 ? four.reverse() : four, Array(4).fill([0, 0, 1]));
      }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(points), 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(new Float32Array(directions), 3));
    return geometry;
  }

  function placeRing(mesh, ring, motion) {
    mesh.position.set(ring.centre_mm + motion[2], motion[0], motion[1]);
    const turn = new THREE.Vector3(motion[5], motion[3], motion[4]), angle = turn.length();
    if (angle > 0) mesh.quaternion.setFromAxisAngle(turn.divideScalar(angle), angle);
    else mesh.quaternion.identity();
  }

  // --- a view --------------------------------------------------------------------------------

  class View {
    constructor(figure, view, surface) {
      this.view = view;
      this.surface = surface;
      this.colour = palette(view.colours);
      this.canvas = figure.querySelector("canvas");
      this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, alpha: true, antialias: true });
      this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace; // colours as in the colour bar
      this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
      this.camera = new THREE.PerspectiveCamera(FIELD_OF_VIEW, 1, 1, 10000);
      this.scene = new THREE.Scene();
      this.addLights();
      this.addBody();
      this.addRings();
      this.box = this.boxOfAllStates();
      this.controls = new THREE.OrbitControls(this.camera, this.canvas);
      this.controls.enableZoom = false; // until it is clicked at: the wheel scrolls the page
      this.controls.addEventListener("change", () => this.draw());
      this.cutOpen(false);
      this.showAt(0);
      new ResizeObserver(() => this.resize()).observe(this.canvas.parentElement);
      this.resize();
      this.reset();
    }

    addLights() {
      const lamp = new THREE.DirectionalLight(0xffffff, (1 - AMBIENT) * Math.PI);
      lamp.position.set(0.3, 0.6, 1);
      this.camera.add(lamp, lamp.target);
      this.scene.add(this.camera, new THREE.AmbientLight(0xffffff, AMBIENT * Math.PI));
    }

    addBody() {
      const count = this.surface.rigid.length;
      this.body = new THREE.BufferGeometry();
      for (const name of ["position", "normal", "color"])
        this.body.setAttribute(name, new THREE.BufferAttribute(new Float32Array(3 * count), 3));
      const materials = [THREE.MeshLambertMaterial, THREE.MeshBasicMaterial].map((Kind) => new Kind({ vertexColors: true }));
      const mesh = new THREE.Mesh(this.body, materials); // the cut is not shaded
      mesh.frustumCulled = false; // its box changes with the state
      this.scene.add(mesh);
    }

    addRings() {
      const material = new THREE.MeshLambertMaterial({ color: 0xb8b8b8 });
      this.rings = this.view.rings.map((ring) => {
        const mesh = new THREE.Mesh(ringGeometry(ring, false), material);
        mesh.whole = mesh.geometry;
        mesh.half = ringGeometry(ring, true);
        this.scene.add(mesh);
        return mesh;
      });
    }

    boxOfAllStates() {
      const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
      for (const { points } of this.surface.states)
        points.forEach((value, k) => {
          low[k % 3] = Math.min(low[k % 3], value);
          high[k % 3] = Math.max(high[k % 3], value);
        });
      for (const ring of this.view.rings) {
        const outer = ring.inner_radius_mm + ring.height_mm;
        for (const axis of [1, 2]) {
          low[axis] = Math.min(low[axis], -outer);
          high[axis] = Math.max(high[axis], outer);
        }
      }
      return { low, high };
    }

    /** Show the state at a place between 0 and the last state's number, straight between two. */
    showAt(place) {
      const last = this.surface.states.length - 1;
      const low = Math.min(Math.floor(place), Math.max(last - 1, 0)), t = place - low;
      const one = this.surface.states[low], other = this.surface.states[Math.min(low + 1, last)];
      const { position, normal, color } = this.body.attributes;
      for (let k = 0; k < position.array.length; k++) {
        position.array[k] = one.points[k] + t * (other.points[k] - one.points[k]);
        normal.array[k] = one.normals[k] + t * (other.normals[k] - one.normals[k]);
      }
      for (let k = 0; k < this.surface.rigid.length; k++) {
        const share = one.shares[k] + t * (other.shares[k] - one.shares[k]);
        color.array.set(this.surface.rigid[k] ? GREY : this.colour(share), 3 * k);
      }
      for (const attribute of [position, normal, color]) attribute.needsUpdate = true;
      const from = this.view.states[low].rings, to = this.view.states[Math.min(low + 1, last)].rings;
      this.rings.forEach((mesh, k) => {
        placeRing(mesh, this.view.rings[k], from[k].map((value, j) => value + t * (to[k][j] - value)));
      });
      this.draw();
    }

    cutOpen(cut) {
      const { behind, before } = this.surface, second = cut ? this.surface.cut : before;
      const index = new Uint32Array(behind.length + second.length);
      index.set(behind);
      index.set(second, behind.length);
      this.body.setIndex(new THREE.BufferAttribute(index, 1));
      this.body.clearGroups();
      this.body.addGroup(0, behind.length, 0);
      this.body.addGroup(behind.length, second.length, cut ? 1 : 0);
      for (const mesh of this.rings) mesh.geometry = cut ? mesh.half : mesh.whole;
      this.draw();
    }

    /** Look at the whole from the side, from above and towards the tip. */
    reset() {
      const { low, high } = this.box, middle = low.map((value, k) => 0.5 * (value + high[k]));
      this.controls.target.set(...middle);
      const { polar, azimuth } = this.camera.aspect < NARROW_ASPECT ? NARROW : WIDE;
      const towards = new THREE.Vector3().setFromSpherical(new THREE.Spherical(1, polar, azimuth));
      this.camera.position.copy(this.controls.target).add(towards);
      this.camera.lookAt(this.controls.target);
      this.camera.updateMatrixWorld();
      const right = new THREE.Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0);
      const up = new THREE.Vector3().setFromMatrixColumn(this.camera.matrixWorld, 1);
      const slope = Math.tan((0.5 * FIELD_OF_VIEW * Math.PI) / 180);
      let distance = 0;
      for (let corner = 0; corner < 8; corner++) {
        const arm = new THREE.Vector3(...[0, 1, 2].map((k) => (corner & (1 << k) ? high[k] : low[k]) - middle[k]));
        const across = Math.abs(arm.dot(right)) / this.camera.aspect, along = Math.abs(arm.dot(up));
        distance = Math.max(distance, Math.max(across, along) / slope + arm.dot(towards));
      }
      this.camera.position.copy(this.controls.target).addScaledVector(towards, 1.03 * distance);
      this.controls.update();
      this.draw();
    }

    turn(azimuth, polar) {
      const arm = this.camera.position.clone().sub(this.controls.target);
      const at = new THREE.Spherical().setFromVector3(arm);
      at.theta += azimuth;
      at.phi = Math.min(Math.max(at.phi + polar, 0.01), Math.PI - 0.01);
      this.camera.position.copy(this.controls.target).add(arm.setFromSpherical(at));
      this.controls.update();
      this.draw();
    }

    zoom(factor) {
      const arm = this.camera.position.clone().sub(this.controls.target).divideScalar(factor);
      this.camera.position.copy(this.controls.target).add(arm);
      this.controls.update();
      this.draw();
    }

    resize() {
      const { clientWidth, clientHeight } = this.canvas.parentElement;
      if (!clientWidth || !clientHeight) return;
      this.renderer.setSize(clientWidth, clientHeight, false);
      this.camera.aspect = clientWidth / clientHeight;
      this.camera.updateProjectionMatrix();
      this.draw();
    }

    draw() {
      this.renderer.render(this.scene, this.camera);
    }
  }

  // --- its controls --------------------------------------------------------------------------

  const number = (value, decimals) => value.toFixed(decimals).replace("-", "\u2212");
  const short = (value) => String(Number(value.toPrecision(4))).replace("-", "\u2212");

  /** Place of a pressure among the states, and the place as words. */
  function placeOf(states, kpa) {
    let low = 0;
    while (low < states.length - 2 && states[low + 1].kpa <= kpa) low++;
    const other = states[Math.min(low + 1, states.length - 1)], width = other.kpa - states[low].kpa;
    return low + (width > 0 ? (kpa - states[low].kpa) / width : 0);
  }

  function wordsFor(states, place, kpa) {
    const near = Math.round(place);
    if (Math.abs(place - near) < 1e-6) {
      const { kpa: exact, tip_mm: tip, largest } = states[near];
      const moved = tip === null ? "" : `, tip ${tip < 0 ? "" : "+"}${number(tip, 2)} mm on this mesh`;
      return `${short(exact)} kPa${moved}, largest stretch drawn ${number(largest, 2)}`;
    }
    const low = Math.floor(place);
    return `${short(kpa)} kPa, between the solved states at ${short(states[low].kpa)} and ${short(states[low + 1].kpa)} kPa`;
  }

  function connectSlider(figure, view, states) {
    const slider = figure.querySelector("input"), output = figure.querySelector("output");
    const show = () => {
      const kpa = Number(slider.value), place = placeOf(states, kpa), words = wordsFor(states, place, kpa);
      output.textContent = words;
      slider.setAttribute("aria-valuetext", words);
      view.showAt(place);
    };
    slider.addEventListener("input", show);
    for (const button of figure.querySelectorAll("[data-kpa]"))
      button.addEventListener("click", () => {
        slider.value = button.dataset.kpa;
        show();
      });
    show();
  }

  function connectButtons(figure, view) {
    const actions = {
      in: () => view.zoom(ZOOM),
      out: () => view.zoom(1 / ZOOM),
      reset: () => view.reset(),
      cut: (button) => {
        const cut = button.getAttribute("aria-pressed") !== "true";
        button.setAttribute("aria-pressed", String(cut));
        view.cutOpen(cut);
      },
    };
    for (const button of figure.querySelectorAll("[data-action]"))
      button.addEventListener("click", () => actions[button.dataset.action](button));
  }

  function connectKeys(view) {
    const keys = {
      ArrowLeft: () => view.turn(-TURN, 0),
      ArrowRight: () => view.turn(TURN, 0),
      ArrowUp: () => view.turn(0, -TURN),
      ArrowDown: () => view.turn(0, TURN),
      "+": () => view.zoom(ZOOM),
      "-": () => view.zoom(1 / ZOOM),
      Home: () => view.reset(),
    };
    view.canvas.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key]) return;
      event.preventDefault();
      keys[event.key]();
    });
    view.canvas.addEventListener("pointerdown", () => view.canvas.focus({ preventScroll: true }));
    view.canvas.addEventListener("focus", () => (view.controls.enableZoom = true));
    view.canvas.addEventListener("blur", () => (view.controls.enableZoom = false));
  }

  async function start(figure) {
    const data = JSON.parse(figure.querySelector("script").textContent);
    try {
      const view = new View(figure, data, await bodySurface(data));
      connectSlider(figure, view, data.states);
      connectButtons(figure, view);
      connectKeys(view);
      figure.dataset.ready = "";
    } catch (error) {
      figure.querySelector("output").textContent = `No 3D view here: ${error.message}`;
      figure.dataset.failed = "";
    }
  }

  THREE.ColorManagement.enabled = false;
  const seen = new IntersectionObserver(
    (entries) => {
      for (const entry of entries.filter((e) => e.isIntersecting)) {
        seen.unobserve(entry.target);
        start(entry.target);
      }
    },
    { rootMargin: "200px" },
  );
  for (const figure of document.querySelectorAll("figure.view3d")) seen.observe(figure);
})();
