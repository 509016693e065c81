#include "link/coding/h264_stream.hpp"

#include <wels/codec_api.h>

#include <algorithm>
#include <climits>
#include <cstring>

#include "common/error.hpp"

namespace foresight {
namespace {

constexpr int kQuiet = WELS_LOG_QUIET;
constexpr int kRate = 10;              // pictures per second, nominally: only bytes per picture count
constexpr int kFirstTimesAsLarge = 4;  // a picture predicted from none gets so much more from the library's control
constexpr int kFinest = 18;            // quantiser step; finer ones code the sensor's noise
constexpr std::size_t kMostBytes = 1U << 24;

[[noreturn]] void fail(const char* what, long code) {
  throw RuntimeFailure(std::string("OpenH264 cannot ") + what + " (" + std::to_string(code) + ")",
                       "use pictures of 16 x 16 to 4096 x 2048 px, or JPEG");
}

}  // namespace

struct H264Encoder::State {
  struct Delete {
    void operator()(ISVCEncoder* encoder) const {
      encoder->Uninitialize();
      WelsDestroySVCEncoder(encoder);
    }
  };
  std::unique_ptr<ISVCEncoder, Delete> encoder;
  cv::Size size;
  bool begun = false;
};

H264Encoder::H264Encoder(cv::Size size) : state_(std::make_unique<State>()) {
  ISVCEncoder* made = nullptr;
  if (const int code = WelsCreateSVCEncoder(&made); code != 0 || !made) fail("be started", code);
  state_->encoder.reset(made);
  state_->size = size;
  made->SetOption(ENCODER_OPTION_TRACE_LEVEL, const_cast<int*>(&kQuiet));
  SEncParamExt p{};
  made->GetDefaultParams(&p);
  p.iUsageType = CAMERA_VIDEO_REAL_TIME;
  p.iPicWidth = size.width;
  p.iPicHeight = size.height;
  p.fMaxFrameRate = kRate;
  p.iTargetBitrate = kRate * 8 * size.area() / 40;
  p.iMaxBitrate = UNSPECIFIED_BIT_RATE;
  p.iRCMode = RC_QUALITY_MODE;  // within the picture; the sender says for each what it may take
  p.iMinQp = kFinest;
  p.iMaxQp = 51;
  p.iNumRefFrame = 1;
  p.uiIntraPeriod = 0;
  p.eSpsPpsIdStrategy = CONSTANT_ID;
  p.iEntropyCodingModeFlag = 1;
  p.bEnableFrameSkip = false;
  p.iMultipleThreadIdc = 1;  // the same bytes on every machine
  p.bEnableLongTermReference = false;
  // Each of these leaves parts of a picture as they were, or begins the stream anew, on its own judgement.
  p.bEnableDenoise = p.bEnableBackgroundDetection = p.bEnableAdaptiveQuant = p.bEnableSceneChangeDetect = false;
  p.iComplexityMode = MEDIUM_COMPLEXITY;
  SSpatialLayerConfig& layer = p.sSpatialLayers[0];
  layer.iVideoWidth = size.width;
  layer.iVideoHeight = size.height;
  layer.fFrameRate = kRate;
  layer.uiProfileIdc = PRO_MAIN;
  layer.iSpatialBitrate = p.iTargetBitrate;
  layer.iMaxSpatialBitrate = UNSPECIFIED_BIT_RATE;
  layer.sSliceArgument.uiSliceMode = SM_SINGLE_SLICE;
  if (const int code = made->InitializeExt(&p); code != 0) fail("encode pictures of this size", code);
  made->SetOption(ENCODER_OPTION_TRACE_LEVEL, const_cast<int*>(&kQuiet));
}

H264Encoder::~H264Encoder() = default;
H264Encoder::H264Encoder(H264Encoder&&) noexcept = default;
H264Encoder& H264Encoder::operator=(H264Encoder&&) noexcept = default;

std::vector<std::uint8_t> H264Encoder::encode(const Planes& planes, std::size_t bytes, bool intra) {
  State& s = *state_;
  const auto wanted = static_cast<int>(std::clamp<std::size_t>(bytes, 64, kMostBytes));
  SBitrateInfo rate{SPATIAL_LAYER_ALL, kRate * 8 * (intra || !s.begun ? wanted / kFirstTimesAsLarge : wanted)};
  if (const int code = s.encoder->SetOption(ENCODER_OPTION_BITRATE, &rate); code != 0) fail("change its quality", code);
  if (intra && s.begun) s.encoder->ForceIntraFrame(true);
  s.begun = true;
  SSourcePicture source{};
  auto* pixels = const_cast<std::uint8_t*>(planes.y());  // the library's structure has no const, and writes nothing
  source.iColorFormat = videoFormatI420;
  source.iPicWidth = s.size.width;
  source.iPicHeight = s.size.height;
  source.iStride[0] = s.size.width;
  source.iStride[1] = source.iStride[2] = s.size.width / 2;
  source.pData[0] = pixels;
  source.pData[1] = pixels + s.size.area();
  source.pData[2] = source.pData[1] + s.size.area() / 4;
  SFrameBSInfo info{};
  if (const int code = s.encoder->EncodeFrame(&source, &info); code != 0) fail("encode", code);
  std::vector<std::uint8_t> out;
  out.reserve(static_cast<std::size_t>(std::max(0, info.iFrameSizeInBytes)));
  for (int layer = 0; layer < info.iLayerNum; ++layer) {
    const SLayerBSInfo& part = info.sLayerInfo[layer];
    int size = 0;
    for (int nal = 0; nal < part.iNalCount; ++nal) size += part.pNalLengthInByte[nal];
    out.insert(out.end(), part.pBsBuf, part.pBsBuf + size);
  }
  if (out.empty()) fail("encode: it gave no bytes", info.eFrameType);
  return out;
}

struct H264Decoder::State {
  struct Delete {
    void operator()(ISVCDecoder* decoder) const {
      decoder->Uninitialize();
      WelsDestroyDecoder(decoder);
    }
  };
  std::unique_ptr<ISVCDecoder, Delete> decoder;
};

H264Decoder::H264Decoder() : state_(std::make_unique<State>()) {
  ISVCDecoder* made = nullptr;
  if (const long code = WelsCreateDecoder(&made); code != 0 || !made) fail("decode", code);
  state_->decoder.reset(made);
  made->SetOption(DECODER_OPTION_TRACE_LEVEL, const_cast<int*>(&kQuiet));
  SDecodingParam parameters{};
  parameters.uiTargetDqLayer = UCHAR_MAX;
  parameters.eEcActiveIdc = ERROR_CON_DISABLE;  // what is damaged is not shown, instead of made up
  parameters.sVideoProperty.size = sizeof(parameters.sVideoProperty);
  parameters.sVideoProperty.eVideoBsType = VIDEO_BITSTREAM_AVC;
  if (const long code = made->Initialize(&parameters); code != 0) fail("decode", code);
}

H264Decoder::~H264Decoder() = default;
H264Decoder::H264Decoder(H264Decoder&&) noexcept = default;
H264Decoder& H264Decoder::operator=(H264Decoder&&) noexcept = default;

std::optional<Planes> H264Decoder::decode(std::span<const std::uint8_t> bytes, cv::Size size) {
  std::uint8_t* planes[3] = {};
  SBufferInfo info{};
  const DECODING_STATE state =
      state_->decoder->DecodeFrameNoDelay(bytes.data(), static_cast<int>(bytes.size()), planes, &info);
  if (state != dsErrorFree) return std::nullopt;
  // With Main profile the library keeps a picture back for those that might come before it.
  if (info.iBufferStatus != 1) state_->decoder->FlushFrame(planes, &info);
  const SSysMEMBuffer& buffer = info.UsrData.sSystemBuffer;
  if (info.iBufferStatus != 1 || !planes[0] || buffer.iWidth != size.width || buffer.iHeight != size.height)
    return std::nullopt;
  Planes out{size, std::vector<std::uint8_t>(static_cast<std::size_t>(size.area() * 3 / 2))};
  std::uint8_t* to = out.y();
  for (int plane = 0; plane < 3; ++plane) {
    const int rows = plane == 0 ? size.height : size.height / 2;
    const auto width = static_cast<std::size_t>(plane == 0 ? size.width : size.width / 2);
    const std::uint8_t* from = planes[plane];
    for (int row = 0; row < rows; ++row, to += width, from += buffer.iStride[plane == 0 ? 0 : 1])
      std::memcpy(to, from, width);
  }
  return out;
}

}  // namespace foresight
