"""The process that works on files is ended while work waits for it."""

import asyncio

import pytest

from studio.errors import StudioError
from studio.web.worker_process import WorkerProcess


def test_work_that_had_not_begun_when_the_process_was_ended_is_told_so():
    async def end_at_once():
        process = WorkerProcess()
        asked = [asyncio.create_task(process.run(abs, -n)) for n in range(3)]
        await asyncio.sleep(0)
        process.close()
        for task in asked:
            with pytest.raises(StudioError, match="ended"):
                await task
        assert await process.run(abs, -3) == 3  # the next one begins another
        process.close()

    asyncio.run(end_at_once())


def test_whoever_cancels_their_own_wait_is_cancelled():
    async def cancel():
        process = WorkerProcess()
        task = asyncio.create_task(process.run(abs, -1))
        await asyncio.sleep(0)
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task
        process.close()

    asyncio.run(cancel())
