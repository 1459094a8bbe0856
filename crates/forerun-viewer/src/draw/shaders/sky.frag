uniform vec3 forward;
// Half the picture's width and height at distance 1.
uniform vec3 across;
uniform vec3 upwards;
uniform vec3 zenith;
uniform vec3 nadir;

in vec2 spot;

layout (location = 0) out vec4 colour;

void main() {
    vec3 ray = normalize(forward + spot.x * across + spot.y * upwards);
    float height = abs(ray.y);
    vec3 seen = mix(hazeColour, ray.y > 0.0 ? zenith : nadir, sqrt(height));
    float glow = max(dot(ray, toSun), 0.0);
    seen += sun * 0.10 * pow(glow, 24.0);
    colour = vec4(screen(seen), 1.0);
}
