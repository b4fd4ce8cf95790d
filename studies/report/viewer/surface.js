// The surface of a body in its states, from what the page brings along.
const bodySurface = (() => {
  "use strict";

  // Neighbouring faces that meet in a sharper edge are not shaded as one: cosine of 40 degrees.
  const SMOOTH_COS = 0.766;

  // --- the payload ---------------------------------------------------------------------------

  async function inflate(text) {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Response(stream).arrayBuffer();
  }

  /** Typed arrays of the payload, in the order in which Python has written them. */
  async function unpack(view) {
    const buffer = await inflate(view.data);
    const faces = view.counts[0] + view.counts[1] + view.counts[2], states = view.states.length;
    let at = 0;
    const take = (Kind, length) => {
      const found = new Kind(buffer, at, length);
      at += found.byteLength;
      return found;
    };
    return {
      faces: take(Uint32Array, view.face_nodes * faces),
      positions: take(Uint16Array, states * 3 * view.nodes),
      stretches: take(Uint8Array, states * view.nodes),
      rigid: take(Uint8Array, faces),
    };
  }

  // --- the surface ---------------------------------------------------------------------------

  /** Values at the places of all faces' flat pieces, from values at the nodes; exact, as weights are dyadic. */
  function spread(values, faces, weights, out, stride, offset) {
    const count = faces.length / weights[0].length;
    for (let face = 0, k = offset; face < count; face++) {
      for (const row of weights) {
        let sum = 0;
        for (let n = 0; n < row.length; n++) if (row[n] !== 0) sum += row[n] * values[faces[n * count + face]];
        out[k] = sum;
        k += stride;
      }
    }
  }

  function spreadPoints(view, arrays, state) {
    const places = (arrays.faces.length / view.face_nodes) * view.weights.length;
    const out = new Float32Array(3 * places);
    for (let axis = 0; axis < 3; axis++) {
      const first = (3 * state + axis) * view.nodes;
      spread(arrays.positions.subarray(first, first + view.nodes), arrays.faces, view.weights, out, 3, axis);
    }
    return out;
  }

  function triangles(view, faces) {
    const pieces = view.triangles.flat(), out = new Uint32Array(faces * pieces.length);
    for (let face = 0, k = 0; face < faces; face++)
      for (const place of pieces) out[k++] = face * view.weights.length + place;
    return out;
  }

  /** From numbers on the grid of the payload to mm, the body's z to the right, x upwards, y to the viewer. */
  function toScene(points, view) {
    const out = new Float32Array(points.length);
    for (let k = 0; k < points.length; k += 3)
      for (let axis = 0; axis < 3; axis++)
        out[k + ((axis + 1) % 3)] = view.origin[axis] + view.step[axis] * points[k + axis];
    return out;
  }

  function normals(points, index) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(points, 3));
    geometry.setIndex(new THREE.BufferAttribute(index, 1));
    geometry.computeVertexNormals();
    return geometry.attributes.normal.array;
  }

  /** The vertex of every place: places of neighbouring faces are one where the body at rest is smooth. */
  function weld(grid, normal, kinds) {
    const vertex = new Uint32Array(grid.length / 3), places = [], met = new Map();
    for (let place = 0; place < vertex.length; place++) {
      const k = 3 * place, key = `${grid[k]},${grid[k + 1]},${grid[k + 2]},${kinds[place]}`;
      const here = met.get(key) ?? met.set(key, []).get(key);
      const dot = (j) => normal[3 * j] * normal[k] + normal[3 * j + 1] * normal[k + 1] + normal[3 * j + 2] * normal[k + 2];
      let found = here.find((v) => dot(places[v]) > SMOOTH_COS);
      if (found === undefined) {
        found = places.push(place) - 1;
        here.push(found);
      }
      vertex[place] = found;
    }
    return { vertex, places: Uint32Array.from(places) };
  }

  function pick(values, places, width) {
    const out = new Float32Array(width * places.length);
    places.forEach((place, k) => {
      for (let axis = 0; axis < width; axis++) out[width * k + axis] = values[width * place + axis];
    });
    return out;
  }

  /** Vertices of the surface in every state, the triangles of its three parts, and which vertices are rigid. */
  function buildSurface(view, arrays) {
    const faces = arrays.rigid.length, per = view.weights.length;
    const rest = Math.max(view.states.findIndex((state) => state.kpa === 0), 0);
    const grid = spreadPoints(view, arrays, rest), split = triangles(view, faces);
    const kinds = Uint8Array.from({ length: faces * per }, (_, place) => arrays.rigid[Math.floor(place / per)]);
    const { vertex, places } = weld(grid, normals(toScene(grid, view), split), kinds);
    const index = split.map((place) => vertex[place]);
    const states = view.states.map((_, k) => {
      const points = pick(toScene(spreadPoints(view, arrays, k), view), places, 3);
      const stretches = new Float32Array(faces * per), first = k * view.nodes;
      spread(arrays.stretches.subarray(first, first + view.nodes), arrays.faces, view.weights, stretches, 1, 0);
      return { points, normals: normals(points, index), shares: pick(stretches, places, 1).map((s) => s / 255) };
    });
    const width = 3 * view.triangles.length, ends = view.counts.map((n) => n * width);
    return {
      states,
      rigid: pick(kinds, places, 1),
      behind: index.subarray(0, ends[0]),
      before: index.subarray(ends[0], ends[0] + ends[1]),
      cut: index.subarray(ends[0] + ends[1]),
    };
  }

  /** The surface of a view's data, a promise. */
  return async (view) => buildSurface(view, await unpack(view));
})();
