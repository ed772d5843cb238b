// Irradiance of a fragment, and how it is shown. Values are linear until the last line of a picture.

const int FROM_NORMALS = 0, FROM_VERTICES = 1;
const int PICTURE = 0, SIGNED = 1, DIFFERENCE = 2, NORMALS = 3, ALBEDO = 4, COLOURS = 5;

in vec3 turnedNormal;
in vec3 paint;
in vec3 brought;

uniform mat4 matrices[3]; // M of red, green and blue, RH01 eq. 12
uniform mat3 towardsLight; // inverse of the light's rotation
uniform int source;
uniform int shown;
uniform bool painted;
uniform float exposure;
uniform vec3 signedColours[5]; // of -1, -1/2, 0, 1/2 and 1
uniform vec3 luminance;

out vec4 colour;

// E(n) = (n, 1)^T M (n, 1), RH01 eq. 11: turning the light is turning the normal the other way.
vec3 irradiance(vec3 n) {
    vec4 point = vec4(towardsLight * n, 1.0);
    return vec3(
        dot(point, matrices[0] * point),
        dot(point, matrices[1] * point),
        dot(point, matrices[2] * point)
    );
}

vec3 inSignedColours(float value) {
    float place = 2.0 * clamp(value, -1.0, 1.0) + 2.0;
    int below = min(int(place), 3);
    return mix(signedColours[below], signedColours[below + 1], place - float(below));
}

void main() {
    vec3 n = normalize(turnedNormal);
    vec3 reflected = painted ? paint : vec3(1.0);
    vec3 received = source == FROM_VERTICES ? brought : irradiance(n);
    vec3 found;
    if (shown == SIGNED) {
        found = inSignedColours(exposure * dot(luminance, reflected * received));
    } else if (shown == DIFFERENCE) {
        found = inSignedColours(exposure * dot(luminance, reflected * (irradiance(n) - brought)));
    } else if (shown == NORMALS) {
        found = 0.5 * (n + 1.0);
    } else if (shown == ALBEDO) {
        found = encoded(paint);
    } else if (shown == COLOURS) {
        found = brought;
    } else {
        found = encoded(exposure * reflected * received);
    }
    colour = vec4(found, 1.0);
}
