#include "client/scene/scene_input.hpp"

namespace trochoid {

const char* name_of(Fidelity fidelity) {
    switch (fidelity) {
        case Fidelity::exact: return "exact";
        case Fidelity::approximate: return "approximate";
        case Fidelity::unknown: break;
    }
    return "unknown";
}

}  // namespace trochoid
