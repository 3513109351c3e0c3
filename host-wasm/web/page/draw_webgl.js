// Draws with WebGL2, if there is no WebGPU.

const CLOTH = `#version 300 es
layout(location=0) in vec3 place; layout(location=1) in vec3 normal; layout(location=2) in float strain;
uniform mat4 matrix; uniform vec4 look; uniform bool body; out vec3 p, n, colour;
void main() {
  float s = clamp(strain / max(look.w, 1e-9), -1., 1.);
  vec3 strained = mix(vec3(.92), s > 0. ? vec3(.8, .1, .1) : vec3(.1, .3, .8), abs(s));
  colour = body ? vec3(.5, .53, .56) : strain > 1e8 ? vec3(.1) : look.w > 0. ? strained : vec3(.85, .62, .45);
  p = place; n = normal; gl_Position = matrix * vec4(place, 1.);
}`;
const SHADE = `#version 300 es
precision highp float; in vec3 p, n, colour; uniform vec4 look; out vec4 seen;
void main() {
  vec3 eye = normalize(look.xyz - p), m = normalize(n);
  if (dot(m, eye) < 0.) m = -m;
  seen = vec4(colour * (.35 + .5 * max(dot(m, normalize(vec3(.4, .9, .5))), 0.) + .2 * max(dot(m, eye), 0.)), 1.);
}`;

/** A renderer for a canvas, or undefined if WebGL2 is not available. `lost` is called when the context is lost. */
export function webgl(canvas, lost) {
  const gl = canvas.getContext("webgl2", { antialias: true });
  if (!gl) return undefined;
  canvas.addEventListener("webglcontextlost", () => lost("the context is lost"), { once: true });
  const program = gl.createProgram();
  for (const [kind, code] of [
    [gl.VERTEX_SHADER, CLOTH],
    [gl.FRAGMENT_SHADER, SHADE],
  ]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, code);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  gl.useProgram(program);
  gl.enable(gl.DEPTH_TEST);
  const at = (name) => gl.getUniformLocation(program, name);
  const [matrixAt, lookAt, bodyAt] = ["matrix", "look", "body"].map(at);
  const buffers = {};
  const buffer = (name) => (buffers[name] ??= gl.createBuffer());
  const column = (location, name, data, size, stride = 0, offset = 0) => {
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer(name));
    if (data) gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, size, gl.FLOAT, false, stride, offset);
  };
  let indices = 0;
  return {
    name: "WebGL2",
    triangles(list) {
      indices = list.length;
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer("triangles"));
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, list, gl.STATIC_DRAW);
    },
    draw({ positions, normals, strains, bodies, matrix, look, paper }) {
      gl.viewport(0, 0, canvas.width, canvas.height);
      gl.clearColor(...paper, 1);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.uniformMatrix4fv(matrixAt, false, matrix);
      gl.uniform4fv(lookAt, look);
      gl.uniform1i(bodyAt, 0);
      column(0, "positions", positions, 3);
      column(1, "normals", normals, 3);
      column(2, "strains", strains, 1);
      gl.drawElements(gl.TRIANGLES, indices, gl.UNSIGNED_INT, 0);
      gl.uniform1i(bodyAt, 1);
      gl.disableVertexAttribArray(2);
      column(0, "bodies", bodies, 3, 24);
      column(1, "bodies", undefined, 3, 24, 12);
      gl.drawArrays(gl.TRIANGLES, 0, bodies.length / 6);
    },
  };
}
