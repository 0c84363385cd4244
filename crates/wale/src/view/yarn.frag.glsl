// The surface of a capsule under the pixel, spun from plies. Appended to light.glsl.
flat in vec3 vA;
flat in vec3 vB;
flat in vec3 vTangentA;
flat in vec3 vTangentB;
flat in vec3 vNormalA;
flat in vec3 vNormalB;
flat in vec4 vSpin;
flat in vec2 vValue;
flat in vec4 vYarn;
in vec3 vPlace;

uniform mat4 uProjection;
uniform bool uParallel;
uniform bool uDepthOnly;
uniform bool uByValue;
uniform sampler2D uMap;
uniform float uPlies;
uniform float uSlope;        // circumference times twist: tangent of the angle at which plies wind
uniform float uPixel;        // length of a pixel at unit depth

out vec4 color;

const float PI = 3.14159265;

// Distance along the ray at which it enters the capsule from outside; negative if it misses.
float entry(vec3 start, vec3 ray, float radius) {
  float shift = dot(0.5 * (vA + vB) - start, ray);
  vec3 origin = start + shift * ray;
  vec3 axis = vB - vA;
  vec3 fromA = origin - vA;
  float aa = dot(axis, axis);
  float ar = dot(axis, ray);
  float af = dot(axis, fromA);
  float fr = dot(fromA, ray);
  float qa = aa - ar * ar;
  vec3 cap = ar < 0.0 ? vB : vA;
  if (qa > 1e-6 * aa) {
    float qb = aa * fr - af * ar;
    float qc = aa * dot(fromA, fromA) - af * af - radius * radius * aa;
    float h = qb * qb - qa * qc;
    if (h < 0.0) return -1.0;
    float t = (-qb - sqrt(h)) / qa;
    float along = af + t * ar;
    if (along > 0.0 && along < aa) return t + shift;
    cap = along <= 0.0 ? vA : vB;
  }
  vec3 fromCap = origin - cap;
  float qb = dot(fromCap, ray);
  float h = qb * qb - (dot(fromCap, fromCap) - radius * radius);
  return h < 0.0 ? -1.0 : shift - qb - sqrt(h);
}

float hash(vec3 p) {
  uvec3 q = uvec3(ivec3(p)) * uvec3(0x9e3779b1u, 0x85ebca6bu, 0xc2b2ae35u);
  uint h = q.x ^ q.y ^ q.z;
  h = (h ^ (h >> 16)) * 0x7feb352du;
  h = (h ^ (h >> 15)) * 0x846ca68bu;
  return float((h ^ (h >> 16)) >> 8) / 16777216.0;
}

// Smooth noise drawn out along the yarn.
float fibres(float around, float count, float along, float ply) {
  float x = fract(around) * count;
  float y = 0.30 * along;
  vec2 cell = floor(vec2(x, y));
  vec2 f = smoothstep(0.0, 1.0, vec2(x, y) - cell);
  float right = mod(cell.x + 1.0, count);
  float low = mix(hash(vec3(cell.x, cell.y, ply)), hash(vec3(right, cell.y, ply)), f.x);
  float high = mix(hash(vec3(cell.x, cell.y + 1.0, ply)), hash(vec3(right, cell.y + 1.0, ply)), f.x);
  return 2.0 * mix(low, high, f.y) - 1.0;
}

void main() {
  float radius = vYarn.a;
  vec3 start = uParallel ? vec3(vPlace.xy, 0.0) : vec3(0.0);
  vec3 ray = uParallel ? vec3(0.0, 0.0, -1.0) : normalize(vPlace);
  float t = entry(start, ray, radius);
  if (t <= 0.0) discard;
  vec3 at = start + t * ray;
  vec4 clip = uProjection * vec4(at, 1.0);
  gl_FragDepth = 0.5 * clip.z / clip.w + 0.5;
  if (uDepthOnly) { color = vec4(1.0); return; }

  vec3 axis = vB - vA;
  float s = clamp(dot(at - vA, axis) / dot(axis, axis), 0.0, 1.0);
  vec3 tangent = normalize(mix(normalize(vTangentA), normalize(vTangentB), s));
  vec3 spoke = at - (vA + s * axis);
  vec3 smoothNormal = normalize(spoke - dot(spoke, tangent) * tangent);
  vec3 zero = mix(vNormalA, vNormalB, s);
  zero = normalize(zero - dot(zero, tangent) * tangent);
  float angle = atan(dot(smoothNormal, cross(tangent, zero)), dot(smoothNormal, zero));
  float around = angle - 2.0 * PI * fract(mix(vSpin.x, vSpin.y, s));
  float along = mix(vSpin.z, vSpin.w, s);
  float detail = clamp((radius / (uPixel * -at.z) - 0.8) / 3.0, 0.0, 1.0);

  float tilt = 0.0;
  float crest = 1.0;
  float streak = 0.0;
  if (uPlies > 1.5) {
    float halfSector = PI / uPlies;
    float sector = floor(around / (2.0 * halfSector));
    float place = around - (sector + 0.5) * 2.0 * halfSector;
    float ply = sin(halfSector) / (1.0 + sin(halfSector));
    float across = (1.0 - ply) * sin(place);
    float reach = sqrt(max(ply * ply - across * across, 0.0));
    float inPly = atan(across, reach);
    crest = 1.0 - detail * (1.0 - reach / ply);
    streak = detail * fibres(inPly / (2.0 * PI) - 0.55 * uSlope / (2.0 * PI) * along, 24.0, along, mod(sector, uPlies));
    tilt = detail * clamp(0.9 * inPly, -1.15, 1.15) + 0.4 * streak;
  } else {
    streak = detail * fibres(around / (2.0 * PI), 36.0, along, 0.0);
    tilt = 0.4 * streak;
  }
  vec3 sideways = cross(tangent, smoothNormal);
  vec3 normal = normalize(cos(tilt) * smoothNormal + sin(tilt) * sideways - uSlope * sin(tilt) * tangent);
  float groove = 1.0 - 0.55 * (1.0 - crest) * (1.0 - crest);
  vec3 base = uByValue ? toLinear(texture(uMap, vec2(mix(vValue.x, vValue.y, s) * 255.0 / 256.0 + 0.5 / 256.0, 0.5)).rgb) : vYarn.rgb;
  base = min(base * (1.0 + 0.26 * streak), 0.95);
  float key = lampAt(at, smoothNormal, 0.35 * radius) * sqrt(groove);
  color = vec4(toSrgb(shoulder(lit(base, normal, smoothNormal, -ray, key, groove) * groove)), 1.0);
}
