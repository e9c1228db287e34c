// One sphere an instance, as a square that faces the eye and covers it with a soft pixel around.

uniform mat4 eye_from_mm, clip_from_eye;
uniform vec2 size_px;

layout(location = 0) in vec3 centre_mm;
layout(location = 1) in vec3 colour_in;
layout(location = 2) in float radius_in_mm;

out vec3 on_square_eye;
flat out vec3 centre_eye, glyph_colour;
flat out float radius_mm, pixel_mm;

void main() {
  bool perspective = clip_from_eye[3][3] == 0.0;
  centre_eye = (eye_from_mm * vec4(centre_mm, 1.0)).xyz;
  glyph_colour = colour_in;
  radius_mm = radius_in_mm;
  pixel_mm = (perspective ? -centre_eye.z : 1.0) * 2.0 / (clip_from_eye[1][1] * size_px.y);

  float distance_mm = length(centre_eye);
  if (perspective && (centre_eye.z > 0.0 || distance_mm <= 1.01 * radius_mm)) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);  // behind or around the eye
    return;
  }
  vec3 forward = perspective ? centre_eye / distance_mm : vec3(0.0, 0.0, -1.0);
  vec3 right = normalize(cross(forward, vec3(0.0, 1.0, 0.0)));
  vec3 up = cross(right, forward);
  // In perspective the cone that touches the sphere is wider at its centre than the sphere is.
  float cone = perspective ? 1.0 / sqrt(1.0 - (radius_mm * radius_mm) / (distance_mm * distance_mm)) : 1.0;
  vec2 corner = (vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0) * (radius_mm * cone + 1.5 * pixel_mm);
  on_square_eye = centre_eye + corner.x * right + corner.y * up;
  gl_Position = clip_from_eye * vec4(on_square_eye, 1.0);
}
