#version 300 es
// Darkens what stands close behind other things, from the depths around a pixel.
precision highp float;
uniform sampler2D uColor;
uniform sampler2D uDepth;
uniform vec2 uSize;          // of the canvas, in pixels
uniform vec2 uClip;          // nearest and farthest depth
uniform vec2 uHalf;          // half width and height of the view at unit depth
uniform float uReach;        // how far things darken each other
out vec4 color;

float depthAt(vec2 uv) {
  float z = 2.0 * texture(uDepth, uv).r - 1.0;
  return 2.0 * uClip.x * uClip.y / (uClip.y + uClip.x - z * (uClip.y - uClip.x));
}
vec3 placeAt(vec2 uv) {
  float depth = depthAt(uv);
  return vec3((2.0 * uv - 1.0) * uHalf * depth, -depth);
}

void main() {
  vec2 uv = gl_FragCoord.xy / uSize;
  vec3 seen = texture(uColor, uv).rgb;
  if (texture(uDepth, uv).r >= 1.0) { color = vec4(seen, 1.0); return; }
  vec3 here = placeAt(uv);
  vec3 right = placeAt(uv + vec2(1.0, 0.0) / uSize) - here;
  vec3 left = here - placeAt(uv - vec2(1.0, 0.0) / uSize);
  vec3 above = placeAt(uv + vec2(0.0, 1.0) / uSize) - here;
  vec3 below = here - placeAt(uv - vec2(0.0, 1.0) / uSize);
  vec3 normal = normalize(cross(abs(right.z) < abs(left.z) ? right : left, abs(above.z) < abs(below.z) ? above : below));
  float turn = 6.2831853 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
  float hidden = 0.0;
  const int COUNT = 14;
  for (int i = 0; i < COUNT; ++i) {
    float part = (float(i) + 0.5) / float(COUNT);
    float angle = turn + 2.3999632 * float(i);
    vec2 d = sqrt(part) * uReach / -here.z * vec2(cos(angle), sin(angle)) / uHalf * 0.5;
    vec3 v = placeAt(uv + d) - here;
    float length2 = dot(v, v);
    float near = max(0.0, 1.0 - length2 / (uReach * uReach * 1.5));
    hidden += near * max(0.0, dot(v, normal) / sqrt(length2 + 1e-14) - 0.2);
  }
  float open = clamp(1.0 - 2.2 * hidden / float(COUNT), 0.0, 1.0);
  // Multiply light, not screen values, and let the colour of neighbours shine back a little.
  vec3 shade = vec3(open) / (1.0 - 0.45 * seen * (1.0 - open));
  color = vec4(seen * pow(shade, vec3(0.8)), 1.0);
}
