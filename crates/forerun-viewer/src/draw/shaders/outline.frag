// A line around what is in the mask.

uniform sampler2D mask;
uniform vec3 lineColour;
// Pixels.
uniform int width;

in vec2 spot;

layout (location = 0) out vec4 colour;

float masked(ivec2 at) {
    ivec2 last = textureSize(mask, 0) - 1;
    return texelFetch(mask, clamp(at, ivec2(0), last), 0).r;
}

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    if (masked(here) > 0.5) { discard; }
    float nearest = 1e6;
    for (int y = -width; y <= width; y++) {
        for (int x = -width; x <= width; x++) {
            if (masked(here + ivec2(x, y)) > 0.5) { nearest = min(nearest, length(vec2(x, y))); }
        }
    }
    float cover = clamp(float(width) + 0.5 - nearest, 0.0, 1.0);
    if (cover <= 0.0) { discard; }
    colour = vec4(lineColour, cover);
}
