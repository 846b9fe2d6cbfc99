#pragma once
#include "protocol/codec/value_coding.hpp"
#include "server_generated.h"

namespace trochoid {

flatbuffers::Offset<wire_fb::Delta> pack(Builder& builder, const Delta& delta);
Delta unpack(Scrutiny& check, const wire_fb::Delta& delta);

}  // namespace trochoid
