#version 300 es
// An obstacle: a plain mesh.
precision highp float;
layout(location = 0) in vec3 aPlace;
layout(location = 1) in vec3 aNormal;
uniform mat4 uModel;
uniform mat4 uView;
uniform mat4 uProjection;
out vec3 vPlace;
out vec3 vNormal;
out vec2 vOwn;
void main() {
  vec4 p = uView * uModel * vec4(aPlace, 1.0);
  vPlace = p.xyz;
  vNormal = mat3(uView) * mat3(uModel) * aNormal;
  vOwn = aPlace.xy;
  gl_Position = uProjection * p;
}
