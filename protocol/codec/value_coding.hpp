#pragma once
#include "protocol/codec/codec.hpp"
#include "protocol/codec/scrutiny.hpp"
#include "values_generated.h"

// Values that several messages carry, to and from the schema's structs and tables.
namespace trochoid {

using Builder = flatbuffers::FlatBufferBuilder;

/// Most wave trains (hence land fields) of any box, spectral ones included.
inline constexpr size_t most_trains_in_a_box = 256;

wire_fb::View pack(const ViewState& view);
/// `widest`: largest tangent of a half-angle (20 for a client's own view).
ViewState unpack(Scrutiny& check, const wire_fb::View& view, float widest);
inline constexpr float widest_view = 20.0F;
/// Anchors of cull keys are padded.
inline constexpr float widest_anchor = 1.0e6F;

flatbuffers::Offset<flatbuffers::Vector<const wire_fb::Region*>> pack(Builder& builder,
                                                                      const std::vector<SyncRegion>& regions);
std::vector<SyncRegion> unpack_regions(Scrutiny& check,
                                       const flatbuffers::Vector<const wire_fb::Region*>* regions);

wire_fb::Clock pack(const SeaClock& clock);
SeaClock unpack(Scrutiny& check, const wire_fb::Clock* clock);

wire_fb::Wind pack(const StartWind& wind);
/// A wind that a director asks for: speed from 1 m/s, at least one train.
StartWind unpack_asked(Scrutiny& check, const wire_fb::Wind* wind);
/// A wind as the log keeps it: speed 0 and 0 trains say that the box came from a scene, not from a wind.
StartWind unpack_logged(Scrutiny& check, const wire_fb::Wind* wind);

/// A heading that waves or a ship travel towards: degrees clockwise from north, [0, 360).
float unpack_heading(Scrutiny& check, const char* name, float degrees);

flatbuffers::Offset<wire_fb::ChangeLand> pack(Builder& builder, const ChangeLand& change);
ChangeLand unpack(Scrutiny& check, const wire_fb::ChangeLand& change);

wire_fb::Leg pack(const CourseLeg& leg);
/// Validated as a course of one leg.
CourseLeg unpack(Scrutiny& check, const wire_fb::Leg* leg);

flatbuffers::Offset<wire_fb::Box> pack(Builder& builder, const WaveTrainBox& box);
/// Validated as a whole by validate(WaveTrainBox).
WaveTrainBox unpack(Scrutiny& check, const wire_fb::Box& box);

flatbuffers::Offset<wire_fb::Goodbye> pack(Builder& builder, const Goodbye& goodbye);
Goodbye unpack(Scrutiny& check, const wire_fb::Goodbye& goodbye);

flatbuffers::Offset<wire_fb::CullKey> pack(Builder& builder, const CullKey& key);
CullKey unpack(Scrutiny& check, const wire_fb::CullKey* key);

PatchKey unpack_patch_key(Scrutiny& check, uint8_t level, int32_t x, int32_t z);

/// 16 bytes.
WorldInstance unpack_instance(Scrutiny& check, const flatbuffers::Vector<uint8_t>* instance);

wire_fb::Code pack(ErrorCode code);
/// Codes of later versions pass as they are, where their class is known.
ErrorCode unpack(Scrutiny& check, wire_fb::Code code);

}  // namespace trochoid
