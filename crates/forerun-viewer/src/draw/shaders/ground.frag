uniform vec3 up;
uniform vec3 earth;
uniform vec3 lineColour;
// How strong the lines are; 0 without a grid.
uniform float lineStrength;

in vec3 point;
in vec2 place;

layout (location = 0) out vec4 colour;

// How much of a pixel is covered by lines so far apart. Never thinner than a pixel: what is farther fades.
float lines(float apart, vec2 pixel, float width) {
    vec2 away = abs(fract(place / apart - 0.5) - 0.5) * apart;
    vec2 half_ = max(pixel * 0.5 * width, vec2(1e-6));
    vec2 covered = clamp((half_ + 0.5 * pixel - away) / pixel, 0.0, 1.0);
    return max(covered.x, covered.y);
}

void main() {
    vec3 toEye = normalize(eye - point);
    vec3 albedo = earth;
    if (lineStrength > 0.0) {
        vec2 pixel = max(fwidth(place), vec2(1e-6));
        // Lines nearer to each other than so many pixels are not drawn; tens of them are.
        float level = log(max(pixel.x, pixel.y) * 14.0) / log(10.0);
        float apart = pow(10.0, ceil(level));
        float fine = ceil(level) - level;
        float strength = 0.34 * fine * lines(apart, pixel, 1.0);
        strength = max(strength, (0.34 + 0.4 * fine) * lines(10.0 * apart, pixel, 1.0));
        strength = max(strength, 0.74 * lines(100.0 * apart, pixel, 1.4));
        // At a grazing angle lines would flicker.
        strength *= smoothstep(0.015, 0.12, abs(dot(toEye, up)));
        albedo = mix(albedo, lineColour, strength * lineStrength);
    }
    colour = vec4(screen(hazed(albedo * lightOn(point, up, toEye), point)), 1.0);
}
