#version 300 es
// One straight piece of a yarn: a cubic through the stored points is cut into uPieces, each drawn as a rectangle that
// covers a capsule. The fragment shader finds the capsule's surface.
precision highp float;
precision highp int;
precision highp usampler2D;

layout(location = 0) in uvec3 aSegment; // point, ends (1: first of its yarn, 2: last), yarn
layout(location = 1) in vec4 aSpin;     // turns of twist at the point and along the segment; length in radii, likewise

uniform usampler2D uPoints;  // xyz: place in steps; w: colour value 0..255
uniform sampler2D uNormals;  // unspun normals
uniform sampler2D uYarns;    // rgb: linear colour; a: radius
uniform vec3 uOrigin;
uniform float uStep;
uniform mat4 uView;
uniform mat4 uProjection;
uniform bool uParallel;
uniform int uPieces;

flat out vec3 vA;
flat out vec3 vB;
flat out vec3 vTangentA;
flat out vec3 vTangentB;
flat out vec3 vNormalA;
flat out vec3 vNormalB;
flat out vec4 vSpin;   // turns at a and b, length in radii at a and b
flat out vec2 vValue;
flat out vec4 vYarn;
out vec3 vPlace;

const int WIDTH = 2048;

ivec2 texel(int i) { return ivec2(i % WIDTH, i / WIDTH); }
vec3 place(int i) { return uOrigin + uStep * vec3(texelFetch(uPoints, texel(i), 0).xyz); }

void main() {
  int k = int(aSegment.x);
  int piece = gl_InstanceID % uPieces;
  vec3 p1 = place(k);
  vec3 p2 = place(k + 1);
  vec3 p0 = (aSegment.y & 1u) != 0u ? 2.0 * p1 - p2 : place(k - 1);
  vec3 p3 = (aSegment.y & 2u) != 0u ? 2.0 * p2 - p1 : place(k + 2);
  vec3 m1 = 0.5 * (p2 - p0);
  vec3 m2 = 0.5 * (p3 - p1);
  vec2 s = vec2(piece, piece + 1) / float(uPieces);
  vec3 c2 = 3.0 * (p2 - p1) - 2.0 * m1 - m2;
  vec3 c3 = 2.0 * (p1 - p2) + m1 + m2;
  vec3 a = p1 + s.x * (m1 + s.x * (c2 + s.x * c3));
  vec3 b = p1 + s.y * (m1 + s.y * (c2 + s.y * c3));
  vec3 ta = m1 + s.x * (2.0 * c2 + s.x * 3.0 * c3);
  vec3 tb = m1 + s.y * (2.0 * c2 + s.y * 3.0 * c3);
  vec3 n1 = texelFetch(uNormals, texel(k), 0).xyz;
  vec3 n2 = texelFetch(uNormals, texel(k + 1), 0).xyz;
  vec2 values = vec2(texelFetch(uPoints, texel(k), 0).w, texelFetch(uPoints, texel(k + 1), 0).w) / 255.0;

  mat3 turn = mat3(uView);
  vA = (uView * vec4(a, 1.0)).xyz;
  vB = (uView * vec4(b, 1.0)).xyz;
  vTangentA = turn * ta;
  vTangentB = turn * tb;
  vNormalA = turn * mix(n1, n2, s.x);
  vNormalB = turn * mix(n1, n2, s.y);
  vSpin = vec4(aSpin.x + s * aSpin.y, aSpin.z + s * aSpin.w);
  vValue = mix(values.xx, values.yy, s);
  vYarn = texelFetch(uYarns, texel(int(aSegment.z)), 0);

  float radius = vYarn.a;
  vec3 centre = 0.5 * (vA + vB);
  vec3 axis = 0.5 * (vB - vA);
  vec3 sight = uParallel ? vec3(0.0, 0.0, -1.0) : normalize(centre);
  vec3 side = cross(axis, sight);
  side = dot(side, side) > 1e-20 ? normalize(side) : normalize(cross(sight, vec3(0.3, 0.9, 0.1)));
  vec3 along = cross(sight, side);
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  float reach = 1.08 * radius;
  vPlace = centre - (radius + abs(dot(axis, sight))) * sight
    + corner.x * reach * side
    + corner.y * (abs(dot(axis, along)) + reach) * along;
  gl_Position = uProjection * vec4(vPlace, 1.0);
}
