uniform float opacity;

in vec2 around;
flat in float length_;
flat in vec2 halves;
in vec4 paint;

layout (location = 0) out vec4 colour;

void main() {
    float beyond = max(max(-around.x, around.x - length_), 0.0);
    float part = length_ > 1e-3 ? clamp(around.x / length_, 0.0, 1.0) : 0.0;
    float away = length(vec2(beyond, around.y));
    float cover = clamp(mix(halves.x, halves.y, part) - away + 0.5, 0.0, 1.0);
    if (cover <= 0.0) { discard; }
    colour = vec4(paint.rgb, paint.a * cover * opacity);
}
