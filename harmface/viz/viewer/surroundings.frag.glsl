// The environment map behind the object, or as a mirror sphere shows it.

const float PI = 3.141592653589793;

in vec2 place;

uniform sampler2D map; // radiance, lat-long as OpenEXR has it
uniform mat3 towardsLight; // inverse of the light's rotation
uniform bool mirror;
uniform vec2 halfView; // tangents of half the angles of view
uniform float exposure;

out vec4 colour;

void main() {
    vec3 direction = normalize(vec3(halfView * place, -1.0));
    if (mirror) {
        float squared = dot(place, place);
        if (squared > 1.0) discard;
        vec3 n = vec3(place, sqrt(1.0 - squared));
        direction = 2.0 * n.z * n - vec3(0.0, 0.0, 1.0);
    }
    vec3 w = towardsLight * direction;
    // The centre looks to +z, +x is at the left quarter, +y at the top.
    vec2 texel = vec2(0.5 - atan(w.x, w.z) / (2.0 * PI), acos(clamp(w.y, -1.0, 1.0)) / PI);
    // A white surface in radiance L has radiosity pi L: both are shown on one scale.
    colour = vec4(encoded(exposure * PI * textureLod(map, texel, 0.0).rgb), 1.0);
}
