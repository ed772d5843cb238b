#version 300 es
// What both fragment shaders begin with.
precision highp float;

// The sRGB transfer curve, IEC 61966-2-1.
vec3 encoded(vec3 linear) {
    vec3 value = clamp(linear, 0.0, 1.0);
    vec3 curve = 1.055 * pow(value, vec3(1.0 / 2.4)) - 0.055;
    return mix(curve, 12.92 * value, vec3(lessThanEqual(value, vec3(0.0031308))));
}
