uniform mat4 eye_from_mm, clip_from_eye;

layout(location = 0) in vec3 position_mm;
layout(location = 1) in vec3 normal_mm;
layout(location = 2) in vec3 vertex_colour;

out vec3 position_eye, normal_eye, surface_colour;

void main() {
  vec4 eye = eye_from_mm * vec4(position_mm, 1.0);
  position_eye = eye.xyz;
  normal_eye = mat3(eye_from_mm) * normal_mm;
  surface_colour = vertex_colour;
  gl_Position = clip_from_eye * eye;
}
