/** The edges of a mesh. */

/**
 * Both ends of each edge; inner edges have two directions, of which one is taken.
 *
 * @param {import("../decoder/vmesh.js").Mesh} mesh
 */
export function endsOf({ vertices, triangles }) {
  const ends = [];
  /**
   * @param {number} a
   * @param {number} b
   * @param {number} axis
   */
  const isUpright = (a, b, axis) => vertices[2 * a + axis] === vertices[2 * b + axis];
  for (let at = 0; at < triangles.length; at += 3) {
    for (let i = 0; i < 3; i++) {
      const [a, b] = [triangles[at + i], triangles[at + ((i + 1) % 3)]];
      // Those of the border have one; inner ones that are upright or level may be drawn twice.
      if (a < b || isUpright(a, b, 0) || isUpright(a, b, 1)) ends.push(a, b);
    }
  }
  return Uint32Array.from(ends);
}
