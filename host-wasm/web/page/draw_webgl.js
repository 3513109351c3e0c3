// Draws with WebGL2, if there is no WebGPU.

import { COLOURS, SHADOW } from "./look.js";

const PLACE = `#version 300 es
layout(location=0) in vec3 place; layout(location=1) in vec3 normal; layout(location=2) in float given; layout(location=3) in vec2 uv;
uniform mat4 matrix, light; uniform vec4 look; uniform bool body;
out vec3 p, n, l; out vec2 t; flat out int kind; out float strain, mark;
void main() {
  // 0 cloth, 1 strained cloth, 2 body, 3 floor, 4 glass
  kind = body ? 2 + int(given) : look.w > 0. ? 1 : 0;
  mark = given > 1e8 ? 1. : 0.;
  strain = mark > 0. ? 0. : clamp(given / max(look.w, 1e-9), -1., 1.);
  p = place; n = normal; t = uv; l = (light * vec4(place, 1.)).xyz * .5 + .5; gl_Position = matrix * vec4(place, 1.);
}`;
const SHADE = `#version 300 es
precision highp float; precision highp sampler2DShadow;
in vec3 p, n, l; in vec2 t; flat in int kind; in float strain, mark; uniform vec4 look, paper; uniform sampler2DShadow shadow; out vec4 seen;
void main() {
  vec3 eye = normalize(look.xyz - p), m = normalize(n), sun = vec3(${SHADOW.sun}), colour = vec3(${COLOURS.cloth});
  // From below the floor is not seen.
  if (kind == 3 && dot(m, eye) < 0.) discard;
  if (dot(m, eye) < 0.) m = -m;
  vec2 w = fwidth(t), stripe = mix(smoothstep(.25 - w, .25 + w, abs(fract(t) - .5)), vec2(.5), clamp(2. * w, 0., 1.));
  if (kind == 0) colour *= mix(1., .84, stripe.x) * mix(1., .84, stripe.y);
  if (kind == 1) colour = mix(vec3(.93), strain > 0. ? vec3(${COLOURS.stretched}) : vec3(${COLOURS.compressed}), abs(strain));
  if (kind == 2 || kind == 4) colour = vec3(${COLOURS.body});
  if (kind == 3) colour = paper.rgb;
  if (mark > .6) colour = vec3(.1);
  float lit = all(lessThan(abs(l - .5), vec3(.5))) ? texture(shadow, l - vec3(0., 0., .004)) : 1.;
  float shade = .4 + .5 * lit * max(dot(m, sun), 0.) + .18 * max(dot(m, eye), 0.);
  if (kind == 3) shade = .78 + .22 * lit;
  seen = vec4(colour * shade, 1.);
  if (kind == 4) seen = vec4(colour * shade, .15);
}`;
const DEPTH = `#version 300 es
layout(location=0) in vec3 place; uniform mat4 light;
void main() { gl_Position = light * vec4(place, 1.); }`;
const NOTHING = `#version 300 es
void main() {}`;

function linked(gl, vertex, fragment) {
  const program = gl.createProgram();
  for (const [kind, code] of [
    [gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment],
  ]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, code);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  const at = (name) => gl.getUniformLocation(program, name);
  return { program, at: Object.fromEntries(["matrix", "light", "look", "paper", "body"].map((name) => [name, at(name)])) };
}

/** The depth in the view of the sun, as a texture that compares. */
function depthMap(gl) {
  const map = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, map);
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, SHADOW.size, SHADOW.size);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
  const target = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, target);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, map, 0);
  return target;
}

/** A renderer for a canvas, or undefined if WebGL2 is not available. `lost` is called when the context is lost. */
export function webgl(canvas, lost) {
  const gl = canvas.getContext("webgl2", { antialias: true });
  if (!gl) return undefined;
  canvas.addEventListener("webglcontextlost", () => lost("the context is lost"), { once: true });
  const picture = linked(gl, PLACE, SHADE);
  const depth = linked(gl, DEPTH, NOTHING);
  const target = depthMap(gl);
  gl.enable(gl.DEPTH_TEST);
  gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ZERO, gl.ONE);
  gl.polygonOffset(2, 2);
  const buffers = {};
  const buffer = (name) => (buffers[name] ??= gl.createBuffer());
  const column = (location, name, size, stride = 0, offset = 0) => {
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer(name));
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, size, gl.FLOAT, false, stride, offset);
  };
  const write = (name, data) => {
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer(name));
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
  };
  let indices = 0;
  const cloth = () => {
    column(0, "positions", 3);
    column(1, "normals", 3);
    column(2, "strains", 1);
    column(3, "uvs", 2);
    gl.drawElements(gl.TRIANGLES, indices, gl.UNSIGNED_INT, 0);
  };
  const bodies = (from, to) => {
    column(0, "bodies", 3, 28);
    column(1, "bodies", 3, 28, 12);
    column(2, "bodies", 1, 28, 24);
    gl.disableVertexAttribArray(3);
    gl.drawArrays(gl.TRIANGLES, from, to - from);
  };
  return {
    name: "WebGL2",
    mesh({ triangles, uvs }) {
      indices = triangles.length;
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer("triangles"));
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW);
      write("uvs", uvs);
    },
    draw({ positions, normals, strains, bodies: { corners, glass, floor }, matrix, light, look, paper }) {
      Object.entries({ positions, normals, strains, bodies: corners }).forEach(([name, data]) => write(name, data));
      gl.useProgram(depth.program);
      gl.bindFramebuffer(gl.FRAMEBUFFER, target);
      gl.viewport(0, 0, SHADOW.size, SHADOW.size);
      gl.clear(gl.DEPTH_BUFFER_BIT);
      gl.uniformMatrix4fv(depth.at.light, false, light);
      gl.enable(gl.POLYGON_OFFSET_FILL);
      cloth();
      bodies(floor, glass);
      gl.disable(gl.POLYGON_OFFSET_FILL);
      gl.useProgram(picture.program);
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      gl.viewport(0, 0, canvas.width, canvas.height);
      gl.clearColor(...paper, 1);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.uniformMatrix4fv(picture.at.matrix, false, matrix);
      gl.uniformMatrix4fv(picture.at.light, false, light);
      gl.uniform4fv(picture.at.look, look);
      gl.uniform4f(picture.at.paper, ...paper, 1);
      gl.uniform1i(picture.at.body, 0);
      cloth();
      gl.uniform1i(picture.at.body, 1);
      bodies(0, glass);
      gl.enable(gl.BLEND);
      gl.depthMask(false);
      bodies(glass, corners.length / 7);
      gl.depthMask(true);
      gl.disable(gl.BLEND);
    },
  };
}
