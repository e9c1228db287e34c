// One line an instance, as a rectangle on the screen wide enough for its width, round ends and a soft pixel around.

uniform mat4 eye_from_mm, clip_from_eye;
uniform vec2 size_px;
uniform float content_scale;

layout(location = 0) in vec3 from_mm;
layout(location = 1) in vec3 to_mm;
layout(location = 2) in vec4 colour_from;
layout(location = 3) in vec4 colour_to;
layout(location = 4) in float width_px;

out vec4 line_colour;                   // premultiplied
out vec2 along_across_px;               // from the start of the line
flat out float length_px, radius_px;

// Slightly nearer than it is, on the same pixel: a frame on the edge of its plane is not swallowed by it.
vec4 eye_position(vec3 p_mm) {
  vec4 p = eye_from_mm * vec4(p_mm, 1.0);
  bool perspective = clip_from_eye[3][3] == 0.0;
  return perspective ? vec4(p.xyz * 0.998, 1.0) : vec4(p.xy, p.z + 0.5, 1.0);
}

void main() {
  vec4 a = clip_from_eye * eye_position(from_mm), b = clip_from_eye * eye_position(to_mm);
  // Cut at the near plane: behind the eye the division by w would mirror the end.
  float a_near = a.z + a.w, b_near = b.z + b.w;
  if (a_near <= 0.0 && b_near <= 0.0) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }
  if (a_near < 0.0) a = mix(a, b, a_near / (a_near - b_near));
  if (b_near < 0.0) b = mix(b, a, b_near / (b_near - a_near));

  vec3 a_ndc = a.xyz / a.w, b_ndc = b.xyz / b.w;
  vec2 a_px = a_ndc.xy * size_px / 2.0, b_px = b_ndc.xy * size_px / 2.0;
  length_px = length(b_px - a_px);
  radius_px = width_px * content_scale / 2.0;
  vec2 along = length_px > 1e-6 ? (b_px - a_px) / length_px : vec2(1.0, 0.0);
  vec2 across = vec2(-along.y, along.x);
  float reach = radius_px + 1.0;

  bool at_end = (gl_VertexID & 1) != 0;
  along_across_px = vec2(at_end ? length_px + reach : -reach, (gl_VertexID >> 1) != 0 ? reach : -reach);
  line_colour = at_end ? colour_to : colour_from;
  line_colour.rgb *= line_colour.a;
  vec2 p_px = a_px + along * along_across_px.x + across * along_across_px.y;
  gl_Position = vec4(p_px * 2.0 / size_px, at_end ? b_ndc.z : a_ndc.z, 1.0);
}
