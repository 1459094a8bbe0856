// A line as wide as so many pixels, with round ends; a dot where both ends are the same.

uniform mat4 viewProjection;
uniform vec2 viewport;
uniform float near;

in vec2 corner;

// Points in the world, and the widths there in pixels.
in vec4 start;
in vec4 end;
in uvec4 ink;

// From the start along the line and across it. Pixels.
out vec2 around;
flat out float length_;
flat out vec2 halves;
out vec4 paint;

void main() {
    vec4 a = viewProjection * vec4(start.xyz, 1.0);
    vec4 b = viewProjection * vec4(end.xyz, 1.0);
    if (a.w < near && b.w < near) {
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
        return;
    }
    if (a.w < near) { a = mix(a, b, (near - a.w) / (b.w - a.w)); }
    if (b.w < near) { b = mix(b, a, (near - b.w) / (a.w - b.w)); }
    vec2 from = a.xy / a.w * 0.5 * viewport;
    vec2 to = b.xy / b.w * 0.5 * viewport;
    length_ = length(to - from);
    vec2 ahead = length_ > 1e-3 ? (to - from) / length_ : vec2(1.0, 0.0);
    halves = 0.5 * vec2(start.w, end.w);
    float reach = max(halves.x, halves.y) + 1.0;
    around = vec2(corner.x < 0.5 ? -reach : length_ + reach, corner.y * reach);
    vec4 spot = corner.x < 0.5 ? a : b;
    vec2 pixel = from + around.x * ahead + around.y * vec2(-ahead.y, ahead.x);
    paint = vec4(ink) / 255.0;
    gl_Position = vec4(pixel / (0.5 * viewport) * spot.w, spot.z - 2e-4 * spot.w, spot.w);
}
