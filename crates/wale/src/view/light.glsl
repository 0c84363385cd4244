#version 300 es
// What all surfaces share: the lamp, its shadow, the light from all around.
precision highp float;
precision highp int;
precision highp sampler2DShadow;

uniform sampler2DShadow uShadow;
uniform mat4 uToLamp;      // from eye space to the shadow map's 0..1
uniform vec3 uKey;         // unit vector to the lamp, in eye space
uniform float uShadowOn;
uniform float uShadowTexel;

vec3 toLinear(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c)); }
vec3 toSrgb(vec3 c) {
  c = clamp(c, 0.0, 1.0);
  return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}
vec3 shoulder(vec3 x) { return mix(x, 0.8 + 0.2 * (1.0 - exp(-(x - 0.8) / 0.2)), step(0.8, x)); }

float lampAt(vec3 place, vec3 normal, float lift) {
  if (uShadowOn < 0.5) return 1.0;
  vec4 q = uToLamp * vec4(place + lift * normal, 1.0);
  float sum = 0.0;
  for (int i = 0; i < 9; ++i) {
    vec2 d = vec2(i % 3 - 1, i / 3 - 1) * 1.1 * uShadowTexel;
    sum += texture(uShadow, vec3(q.xy + d, q.z));
  }
  return sum / 9.0;
}

// `form` is the normal of the coarse form: the edge that hair brightens is the form's.
vec3 lit(vec3 color, vec3 normal, vec3 form, vec3 toEye, float key, float open) {
  float facing = max((dot(normal, uKey) + 0.18) / 1.18, 0.0);
  float above = 0.5 + 0.5 * normal.y;
  vec3 around = vec3(open) / (1.0 - min(color, 0.9) * (1.0 - open));
  vec3 ambient = mix(vec3(0.43, 0.40, 0.37), vec3(0.56, 0.60, 0.67), above) * around;
  float eye = max(dot(normal, toEye), 0.0);
  vec3 rim = pow(1.0 - max(dot(form, toEye), 0.0), 3.0) * (0.25 * ambient + 0.22 * key * facing);
  return color * (0.97 * vec3(1.0, 0.965, 0.91) * facing * key + ambient + 0.17 * eye) + mix(color, vec3(1.0), 0.35) * rim;
}
