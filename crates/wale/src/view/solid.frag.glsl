// An obstacle's surface. Appended to light.glsl.
in vec3 vPlace;
in vec3 vNormal;
in vec2 vOwn;
uniform vec3 uColor;
uniform vec3 uBackground;
uniform float uEndless;     // reach of a plane that fades into the background; 0 for a solid with an end
uniform bool uDepthOnly;
uniform float uLift;
out vec4 color;
void main() {
  if (uDepthOnly) { color = vec4(1.0); return; }
  vec3 normal = normalize(vNormal);
  vec3 toEye = normalize(-vPlace);
  if (dot(normal, toEye) < 0.0) normal = -normal;
  vec3 light = lit(uColor, normal, normal, toEye, lampAt(vPlace, normal, uLift), 1.0);
  float fade = uEndless > 0.0 ? smoothstep(0.45, 1.0, length(vOwn) / uEndless) : 0.0;
  color = vec4(mix(toSrgb(shoulder(light)), uBackground, fade), 1.0);
}
