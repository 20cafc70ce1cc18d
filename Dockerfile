# docker build -t plcgen .
# docker run --rm -u "$(id -u):$(id -g)" -v "$PWD:/project" plcgen check .
FROM python:3.12-slim AS build
WORKDIR /src
COPY . .
RUN python -m pip install --quiet --require-hashes --no-deps -r ci/build.lock \
 && python -m pip wheel --quiet --no-deps --no-build-isolation --wheel-dir /wheels . \
 && python -m pip wheel --quiet --no-deps --require-hashes --wheel-dir /wheels -r ci/runtime.lock

FROM python:3.12-slim
COPY --from=build /wheels /wheels
RUN python -m pip install --quiet --no-cache-dir --no-index /wheels/*.whl && rm -r /wheels
USER 65534:65534
WORKDIR /project
ENTRYPOINT ["plcgen"]
