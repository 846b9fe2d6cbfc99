#include "protocol/codec/codec.hpp"
#include "protocol/units/hash.hpp"
#include "schema_text_generated.h"

namespace trochoid {

uint64_t schema_hash() {
    Hash64 hash;
    for (const char* text : wire_fb::schema_text) hash.text(text);
    return hash.value();
}

}  // namespace trochoid
