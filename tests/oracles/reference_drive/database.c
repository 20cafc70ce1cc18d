/* Parameters in memory for Siemens' parameter manager: pdrv_parmanager_ac4.c asks ptPdrvPar_GetParObj for them. */
#include <string.h>

#include "pniousrd.h"
#include "pdrv_types_ac4.h"
#include "pdrv_parmanager_ac4.h"
#include "pdrv_pardatabase_ac4.h"

#define MOST 64

static PDRV_PAR_OBJ parameters[MOST];
static unsigned char contents[MOST][4096];
static unsigned sizes[MOST];
static unsigned count;

static unsigned char *place(const PDRV_PAR_OBJ *parameter, PDRV_UINT16 subindex)
{
    unsigned at = (unsigned)(parameter - parameters);
    return &contents[at][subindex * sizes[at]];
}

static PDRV_UINT32 get(const PDRV_PAR_OBJ *parameter, PDRV_UINT16 subindex, PDRV_UINT16 number, PDRV_ParValues *values)
{
    memcpy(values, place(parameter, subindex), number * sizes[parameter - parameters]);
    return PDRV_EV1_NOERROR;
}

static PDRV_UINT32 put(const PDRV_PAR_OBJ *parameter, PDRV_UINT16 subindex, PDRV_UINT16 number, PDRV_ParValues *values)
{
    memcpy(place(parameter, subindex), values, number * sizes[parameter - parameters]);
    return PDRV_EV1_NOERROR;
}

const PDRV_PAR_OBJ *ptPdrvPar_GetParObj(PDRV_UINT16 number)
{
    for (unsigned i = 0; i < count; i++)
        if (parameters[i].uPnu == number)
            return &parameters[i];
    return PDRV_NULL;
}

/* Forget all parameters and connect one controller, application relation 1. */
void reference_reset(void)
{
    count = 0;
    memset(contents, 0, sizeof contents);
    PdrvPar_Init();
    bPdrvPar_EstablishCxn(PNIO_AR_TYPE_SINGLE, 1);
}

/* One more parameter; size is that of an element. */
int reference_define(unsigned number, unsigned identifier, unsigned elements, unsigned size, unsigned low, unsigned high)
{
    if (count == MOST || elements * size > sizeof contents[0])
        return 0;
    PDRV_PAR_OBJ *made = &parameters[count];
    memset(made, 0, sizeof *made);
    made->uPnu = (PDRV_UINT16)number;
    made->uIdentifier = (PDRV_UINT16)identifier;
    made->uNrOfElements = (PDRV_UINT16)elements;
    made->uLoLimit = low;
    made->uHiLimit = high;
    made->puName = "parameter";
    made->pfnRead = get;
    made->pfnWrite = put;
    sizes[count++] = size;
    return 1;
}
