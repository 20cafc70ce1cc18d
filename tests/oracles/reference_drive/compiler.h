/* What the example takes from the compiler's own header of its kit. */
#include <stddef.h>
#include <stdint.h>

typedef unsigned LSA_UINT;
typedef uint8_t LSA_UINT8;
typedef uint16_t LSA_UINT16;
typedef uint32_t LSA_UINT32;
typedef uint64_t LSA_UINT64;
typedef int LSA_INT;
typedef int8_t LSA_INT8;
typedef int16_t LSA_INT16;
typedef int32_t LSA_INT32;
typedef int64_t LSA_INT64;
typedef unsigned LSA_BOOL;
typedef void LSA_VOID;
#define ATTR_PNIO_PACKED_PRE
#define ATTR_PNIO_PACKED __attribute__((packed))
#define PNIO_BIG_ENDIAN 0
