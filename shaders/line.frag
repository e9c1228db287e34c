in vec4 line_colour;
in vec2 along_across_px;
flat in float length_px, radius_px;
out vec4 colour;

void main() {
  float beyond_px = max(max(-along_across_px.x, along_across_px.x - length_px), 0.0);
  float distance_px = length(vec2(beyond_px, along_across_px.y));
  float coverage = clamp(radius_px + 0.5 - distance_px, 0.0, 1.0) * min(2.0 * radius_px, 1.0);
  if (coverage == 0.0) discard;
  colour = line_colour * coverage;
}
