// Light: what a surface sends to the eye. Colours are linear until `screen`.

uniform vec3 eye;
uniform vec3 toSun;
uniform vec3 sun;
uniform vec3 fromSky;
uniform vec3 fromGround;
uniform vec3 hazeColour;
// Metres from the eye at which half of what is seen is haze.
uniform float hazeDistance;

uniform highp sampler2D nearShadow;
uniform highp sampler2D farShadow;
uniform mat4 nearShadowMatrix;
uniform mat4 farShadowMatrix;
// Metres a texel, of the near and of the far map.
uniform vec2 shadowTexels;
// 0: no shadows, 1: the near map holds all, 2: both.
uniform int shadowMaps;

vec3 linearOf(vec3 colour) { return pow(colour, vec3(2.2)); }

// As screens want it, with noise of less than a step so that slow gradients show no bands.
vec3 screen(vec3 colour) {
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 0.5;
    return pow(clamp(colour, 0.0, 1.0), vec3(1.0 / 2.2)) + noise / 255.0;
}

// A square of three by three texels moved with the point, so that edges are smooth.
float unshaded(highp sampler2D map, vec3 at) {
    ivec2 size = textureSize(map, 0);
    vec2 texel = at.xy * vec2(size) - 0.5;
    vec2 base = floor(texel);
    vec2 part = texel - base;
    float sum = 0.0;
    for (int y = -1; y <= 2; y++) {
        float rows = y == -1 ? 1.0 - part.y : (y == 2 ? part.y : 1.0);
        for (int x = -1; x <= 2; x++) {
            float columns = x == -1 ? 1.0 - part.x : (x == 2 ? part.x : 1.0);
            ivec2 place = clamp(ivec2(base) + ivec2(x, y), ivec2(0), size - 1);
            // What is deeper than all that casts is in the shade of what casts there.
            sum += texelFetch(map, place, 0).r < min(at.z, 0.99999) ? 0.0 : rows * columns;
        }
    }
    return sum / 9.0;
}

bool within(vec3 at) { return all(greaterThan(at.xy, vec2(0.003))) && all(lessThan(at.xy, vec2(0.997))); }

// How much of the sun a point sees. A surface casts no shadow on itself: it is asked a texel or two above.
float sunlit(vec3 point, vec3 normal) {
    if (shadowMaps == 0) { return 1.0; }
    float slope = 1.0 - max(dot(normal, toSun), 0.0);
    vec3 lift = normal * (0.6 + 2.0 * slope) + toSun * 0.6;
    vec3 near = (nearShadowMatrix * vec4(point + lift * shadowTexels.x, 1.0)).xyz;
    if (within(near)) { return unshaded(nearShadow, near); }
    if (shadowMaps == 1) { return 1.0; }
    vec3 far = (farShadowMatrix * vec4(point + lift * shadowTexels.y, 1.0)).xyz;
    return within(far) ? unshaded(farShadow, far) : 1.0;
}

vec3 lightOn(vec3 point, vec3 normal, vec3 toEye) {
    float facing = max(dot(normal, toSun), 0.0);
    vec3 around = mix(fromGround, fromSky, 0.5 + 0.5 * normal.y);
    // A little light from the eye: faces in the shade stay distinct.
    around += fromSky * 0.22 * max(dot(normal, toEye), 0.0);
    return around + sun * (facing > 0.0 ? facing * sunlit(point, normal) : 0.0);
}

vec3 hazed(vec3 colour, vec3 point) {
    float far = distance(eye, point) / hazeDistance;
    return mix(colour, hazeColour, far * far / (1.0 + far * far));
}
